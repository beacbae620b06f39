#include "service/daemon/publisher.hpp"

#include <algorithm>
#include <utility>

#include "service/model/model_json.hpp"
#include "service/support/log.hpp"
#include "service/support/version.hpp"

namespace reident {

Publisher::Publisher(dds::Participant& participant, MayPublish may_publish)
    : participant_(participant),
      may_publish_(std::move(may_publish)),
      versions_(std::in_place, participant),
      reports_(participant),
      status_(participant) {}

bool Publisher::write(const storage::Version& version, const storage::Decision& decision,
                      bool follows_a_newer_one) {
  ModelVersion message;
  std::string fault;
  try {
    message.model = equipment_model_from_json(version.model_json);
    if (model_digest(message.model) != version.digest)
      fault = "the model does not match its digest";
  } catch (const std::invalid_argument& error) {
    fault = error.what();
  }
  if (!fault.empty()) {
    log::error("publish", "a version is damaged in the registry and was not published",
               {{"equipment", version.spacecraft + "/" + version.equipment},
                {"version", version.number},
                {"reason", fault}});
    return false;
  }
  message.number = version.number;
  message.digest = version.digest;
  message.decided = decision.time;
  message.decided_by = decision.actor;
  // Said also of a version that was approved after a rollback: a simulator may have missed that.
  message.rollback = decision.kind == storage::DecisionKind::roll_back || follows_a_newer_one;
  message.program_version = program_version();
  versions().write(message);
  return true;
}

bool Publisher::publish_champion(const storage::Registry& registry,
                                 const storage::EquipmentName& equipment) {
  const MutexLock lock(versions_mutex_);
  return publish(registry, equipment, false);
}

bool Publisher::publish(const storage::Registry& registry, const storage::EquipmentName& equipment,
                        bool may_replace_newer) {
  const auto& [spacecraft, name] = equipment;
  const auto made = registry.champion_decision(spacecraft, name);
  if (may_publish_ && !may_publish_(registry)) return false;
  const auto published = published_.find(equipment);
  if (!made) {
    if (published == published_.end()) return true;
    ModelVersion none;
    none.model.spacecraft = spacecraft;
    none.model.equipment = name;
    versions().dispose(none);
    published_.erase(published);
    return true;
  }
  if (!may_replace_newer && published != published_.end() && published->second.decision == made->id)
    return true;
  const auto decisions = registry.decisions(spacecraft, name);
  const bool follows_a_newer_one =
      may_replace_newer ||
      std::any_of(decisions.begin(), decisions.end(), [&](const storage::Decision& earlier) {
        return earlier.id < made->id && earlier.version > made->version &&
               earlier.kind == storage::DecisionKind::approve;
      });
  const auto version = registry.version(spacecraft, name, made->version);
  if (!write(*version, *made, follows_a_newer_one)) return false;
  published_[equipment] = {made->id, made->version};
  return true;
}

std::map<storage::EquipmentName, std::int64_t> Publisher::published() const {
  const MutexLock lock(versions_mutex_);
  std::map<storage::EquipmentName, std::int64_t> versions;
  for (const auto& [equipment, published] : published_) versions[equipment] = published.version;
  return versions;
}

std::size_t Publisher::publish_champions(const storage::Registry& registry,
                                         bool may_replace_newer) {
  const MutexLock lock(versions_mutex_);
  std::size_t published = 0;
  for (const storage::Version& champion : registry.champions())
    if (publish(registry, {champion.spacecraft, champion.equipment}, may_replace_newer))
      ++published;
  return published;
}

void Publisher::retire() {
  const MutexLock lock(versions_mutex_);
  versions_.reset();
  published_.clear();
  try {
    versions();  // so that simulators know it before it publishes again
  } catch (const dds::Error&) {
    // The certificate has ended. It is made with a new one.
  }
}

dds::Writer<ModelVersion>& Publisher::versions() {
  if (!versions_) versions_.emplace(participant_);
  return *versions_;
}

}  // namespace reident
