#include "service/client/model_subscriber.hpp"

#include <algorithm>
#include <unistd.h>
#include <utility>

#include "service/client/name_pattern.hpp"
#include "service/client/version_check.hpp"
#include "service/dds/wire.hpp"
#include "service/support/program_identity.hpp"
#include "service/support/utc_clock.hpp"
#include "service/support/version.hpp"

namespace reident {
namespace {

constexpr std::size_t take_at_most = 256;

storage::EquipmentName name_of(const EquipmentModel& model) {
  return {model.spacecraft, model.equipment};
}

ModelCache::Report report_to(const ModelSubscriber::Listener& listener) {
  return [&listener](const CacheFault& fault) {
    if (listener.cache_fault) listener.cache_fault(fault);
  };
}

}  // namespace

bool Subscription::includes(const storage::EquipmentName& name) const {
  return matches(spacecraft, name.spacecraft) &&
         (equipment.empty() ||
          std::any_of(equipment.begin(), equipment.end(), [&name](const std::string& pattern) {
            return matches(pattern, name.equipment);
          }));
}

ModelSubscriber::ModelSubscriber(dds::Participant& participant, Subscription subscription,
                                 std::optional<ModelCache> cache)
    : participant_(participant),
      subscription_(std::move(subscription)),
      cache_(std::move(cache)),
      versions_(participant),
      acknowledgements_(participant),
      host_(host_name()) {}

void ModelSubscriber::attach_to(dds::WaitSet& wait_set) {
  wait_set.attach(versions_);
}

std::size_t ModelSubscriber::poll(const Listener& listener) {
  std::size_t adopted = 0;
  Listener counting = listener;
  counting.adopt = [&](const ModelVersion& version, const Arrival& arrival) {
    ++adopted;
    if (listener.adopt) listener.adopt(version, arrival);
  };
  if (!std::exchange(handed_out_kept_, true)) hand_out_kept(counting);
  const auto take = [&](ModelVersion&& version, storage::Time sent) {
    if (subscription_.includes(name_of(version.model)))
      consider(std::move(version), {sent, utc_now(), false}, counting);
  };
  const auto pass_on = [&](const ModelVersion& version, const std::string& reason) {
    if (subscription_.includes(name_of(version.model))) refuse(version, reason, counting);
  };
  while (versions_.take(take_at_most, take, pass_on) > 0) {
  }
  return adopted;
}

void ModelSubscriber::hand_out_kept(const Listener& listener) {
  if (!cache_) return;
  for (CachedVersion& kept : cache_->load(report_to(listener))) {
    const storage::EquipmentName name = name_of(kept.version.model);
    if (!subscription_.includes(name)) continue;
    const Verified& verified =
        newest_[name] = {std::move(kept.version), {kept.published, kept.received, true}};
    listener.adopt(verified.version, verified.arrival);
  }
}

void ModelSubscriber::consider(ModelVersion&& version, const Arrival& arrival,
                               const Listener& listener) {
  if (const auto reason = damage(version)) {
    refuse(version, *reason, listener);
    return;
  }
  const storage::EquipmentName name = name_of(version.model);
  if (const auto found = newest_.find(name); found != newest_.end()) {
    const Succession how = succession(version, found->second.version);
    if (how == Succession::same) {
      confirm(found->second, arrival, listener);
      return;
    }
    if (how != Succession::newer) {
      refuse(version, reason_against(version, found->second), listener);
      return;
    }
  }
  forget_refusal(name);
  const Verified& verified = newest_[name] = {std::move(version), arrival};
  listener.adopt(verified.version, verified.arrival);
  keep(verified, listener);
}

std::string ModelSubscriber::reason_against(const ModelVersion& version,
                                            const Verified& newest) const {
  const std::string current = std::to_string(newest.version.number);
  std::string reason = version.number == newest.version.number
                           ? "version " + current +
                                 " is known with another content; do two services publish this "
                                 "equipment?"
                           : "it is older than version " + current + " and not a rollback";
  if (newest.arrival.from_cache)
    reason += "; that was kept from an earlier run: if it is out of use, remove " +
              cache_->file_of(name_of(version.model)).string() + " and start again";
  return reason;
}

void ModelSubscriber::confirm(Verified& newest, const Arrival& arrival, const Listener& listener) {
  forget_refusal(name_of(newest.version.model));
  const bool was_kept = std::exchange(newest.arrival, arrival).from_cache;
  if (was_kept && listener.confirm) listener.confirm(newest.version, newest.arrival);
  keep(newest, listener);
}

void ModelSubscriber::forget_refusal(const storage::EquipmentName& equipment) {
  const auto told = told_.find(equipment);
  if (told == told_.end() || !told->second.refusal) return;
  told->second.refusal.reset();
  tell(equipment);
}

void ModelSubscriber::keep(const Verified& verified, const Listener& listener) {
  if (!cache_) return;
  cache_->store({verified.version, verified.arrival.published, verified.arrival.received},
                report_to(listener));
}

void ModelSubscriber::refuse(const ModelVersion& version, const std::string& reason,
                             const Listener& listener) {
  const storage::EquipmentName name = name_of(version.model);
  const Refusal refusal{name, std::max<std::int64_t>(version.number, 0), reason};
  if (listener.refuse) listener.refuse(refusal);
  dds::TextReader names;
  names.name(name.spacecraft.c_str(), "spacecraft");
  names.name(name.equipment.c_str(), "equipment");
  if (names.fault()) return;  // no acknowledgement can name it
  Told& told = told_[name];
  told.refusal = refusal;
  told.refused_digest = version.digest;
  tell(name);
}

void ModelSubscriber::acknowledge(const storage::EquipmentName& equipment,
                                  const RunningModel& running) {
  Told& told = told_[equipment];
  const Verified* verified = newest(equipment);
  if (verified && verified->version.number == running.version)
    told.running_digest = verified->version.digest;
  else if (running.version != told.running.version)
    told.running_digest.clear();
  told.running = running;
  tell(equipment);
}

void ModelSubscriber::tell(const storage::EquipmentName& equipment) {
  const Told& told = told_[equipment];
  ModelAcknowledgement message;
  message.simulator = subscription_.simulator;
  message.spacecraft = equipment.spacecraft;
  message.equipment = equipment.equipment;
  message.running = told.running;
  message.version = told.running.version;
  message.digest = told.running_digest;
  if (told.refusal) {
    message.version = told.refusal->version;
    message.digest = told.refused_digest;
    message.accepted = false;
    message.reason = told.refusal->reason;
  }
  message.host = host_;
  message.process = static_cast<std::uint64_t>(::getpid());
  message.program_version = program_version();
  acknowledgements_.write(message);
}

const ModelSubscriber::Verified* ModelSubscriber::newest(
    const storage::EquipmentName& equipment) const {
  const auto found = newest_.find(equipment);
  return found == newest_.end() ? nullptr : &found->second;
}

std::string ModelSubscriber::unpublished_text(const storage::EquipmentName& equipment) const {
  const std::string name = equipment.spacecraft + "/" + equipment.equipment;
  if (versions_.matched_writers() > 0)
    return "a service is heard, and none publishes a version of " + name +
           ": it has no champion yet, or the name is another ('reident overview')";
  if (participant_.misses_security())
    return "the domain is secured, and this simulator has no certificate: no version of " + name +
           " comes, and no service hears it; name its folder by security_folder, --security or "
           "REIDENT_SECURITY ('reident security grant' makes one)";
  return "no service is heard, and so no version of " + name +
         " comes: look at the domain and the partition, and whether reidentd runs";
}

}  // namespace reident
