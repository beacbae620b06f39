#include "service/client/model_subscriber.hpp"

#include <algorithm>
#include <limits>

#include "service/client/version_check.hpp"

namespace reident {
namespace {

constexpr std::size_t take_at_most = 256;

}  // namespace

ModelSubscriber::ModelSubscriber(dds::Participant& participant, Subscription subscription)
    : subscription_(std::move(subscription)),
      versions_(participant),
      acknowledgements_(participant) {}

void ModelSubscriber::attach_to(dds::WaitSet& wait_set) {
  wait_set.attach(versions_);
}

bool ModelSubscriber::is_wanted(const EquipmentModel& model) const {
  const std::vector<std::string>& names = subscription_.equipment;
  return model.spacecraft == subscription_.spacecraft &&
         (names.empty() || std::find(names.begin(), names.end(), model.equipment) != names.end());
}

std::size_t ModelSubscriber::poll(const Adopt& adopt, const Refuse& refuse) {
  std::size_t adopted = 0;
  const Adopt count = [&](const ModelVersion& version) {
    ++adopted;
    adopt(version);
  };
  while (versions_.take(
             take_at_most,
             [&](ModelVersion&& version) { consider(std::move(version), count, refuse); },
             [&](const ModelVersion& version, const std::string& reason) {
               if (is_wanted(version.model)) refuse_version(version, reason, refuse);
             }) > 0) {
  }
  return adopted;
}

void ModelSubscriber::consider(ModelVersion&& version, const Adopt& adopt, const Refuse& refuse) {
  if (!is_wanted(version.model)) return;
  if (const auto reason = damage(version)) {
    refuse_version(version, *reason, refuse);
    return;
  }
  const auto running = in_use_.find(version.model.equipment);
  if (running != in_use_.end()) {
    const std::string current = std::to_string(running->second.number);
    switch (succession(version, running->second)) {
      case Succession::same:
        return;
      case Succession::older:
        refuse_version(version, "it is older than version " + current + " and not a rollback",
                       refuse);
        return;
      case Succession::different:
        refuse_version(version,
                       "version " + current +
                           " runs with another content; do two services publish this equipment?",
                       refuse);
        return;
      case Succession::newer:
        break;
    }
  }
  const std::string equipment = version.model.equipment;
  adopt(in_use_[equipment] = std::move(version));
}

void ModelSubscriber::refuse_version(const ModelVersion& version, const std::string& reason,
                                     const Refuse& refuse) {
  ModelAcknowledgement message;
  message.simulator = subscription_.simulator;
  message.spacecraft = version.model.spacecraft;
  message.equipment = version.model.equipment;
  message.version = std::max<std::int64_t>(version.number, 0);
  message.digest = version.digest;
  message.accepted = false;
  message.reason = reason;
  message.running_mrse_percent = std::numeric_limits<double>::quiet_NaN();
  acknowledgements_.write(message);
  refuse({version.model.equipment, version.number, reason});
}

void ModelSubscriber::acknowledge(const std::string& equipment, storage::Time since,
                                  double running_mrse_percent) {
  const ModelVersion* version = in_use(equipment);
  if (version == nullptr) return;
  ModelAcknowledgement message;
  message.simulator = subscription_.simulator;
  message.spacecraft = subscription_.spacecraft;
  message.equipment = equipment;
  message.version = version->number;
  message.digest = version->digest;
  message.since = since;
  message.running_mrse_percent = running_mrse_percent;
  acknowledgements_.write(message);
}

const ModelVersion* ModelSubscriber::in_use(const std::string& equipment) const {
  const auto found = in_use_.find(equipment);
  return found == in_use_.end() ? nullptr : &found->second;
}

}  // namespace reident
