#include "service/daemon/publisher.hpp"

#include "service/model/model_json.hpp"
#include "service/support/log.hpp"
#include "service/support/version.hpp"

namespace reident {

Publisher::Publisher(dds::Participant& participant)
    : versions_(participant), reports_(participant), status_(participant) {}

bool Publisher::publish(const storage::Version& version, const storage::Decision& decision) {
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
  message.rollback = decision.kind == storage::DecisionKind::roll_back;
  message.program_version = program_version();
  versions_.write(message);
  return true;
}

std::size_t Publisher::publish_champions(const storage::Registry& registry) {
  std::size_t published = 0;
  for (const storage::Version& champion : registry.champions()) {
    const auto decision = registry.champion_decision(champion.spacecraft, champion.equipment);
    if (decision && publish(champion, *decision)) ++published;
  }
  return published;
}

}  // namespace reident
