#include "service/client/simulator_report.hpp"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/model/model_json.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident {
namespace {

using Json = nlohmann::ordered_json;

/// Lines leave at once, also into a pipe: somebody waits for them.
void say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// To the second; "0s" where the clock stands before it.
std::string age_text(storage::Time since) {
  constexpr storage::Time second = 1'000'000'000;
  const storage::Time age = std::max<storage::Time>(utc_now() - since, 0);
  return duration_text(age / second * second);
}

}  // namespace

void SimulatorReport::adopted(const ModelVersion& version, const Arrival& arrival,
                              const std::optional<ModelRunner::Swap>& swap) const {
  const EquipmentModel& model = version.model;
  const std::string age = age_text(version.decided);
  if (json_) {
    Json line{{"event", "adopted"},
              {"spacecraft", model.spacecraft},
              {"equipment", model.equipment},
              {"version", version.number},
              {"digest", version.digest},
              {"order", model.dynamics.order()},
              {"rollback", version.rollback},
              {"from_cache", arrival.from_cache},
              {"age", age},
              {"mrse_percent", to_json(model.validation.mrse_percent)},
              {"fit_percent", to_json(model.validation.fit_percent)}};
    if (swap) {
      line["output_change"] = swap->largest;
      line["transition_ticks"] = swap->transition;
    }
    say(line.dump());
    return;
  }
  say(fmt::format("{}/{} v{}: {}, order {}, on unseen data MRSE {:.3f} %, fit {:.1f} %{}",
                  model.spacecraft, model.equipment, version.number,
                  arrival.from_cache ? "kept from an earlier run, approved " + age + " ago"
                  : version.rollback ? "rolled back to"
                                     : "adopted",
                  model.dynamics.order(), model.validation.mrse(), model.validation.fit(),
                  swap ? fmt::format(", output changes by {:.3g} over {} ticks", swap->largest,
                                     swap->transition)
                       : ""));
}

void SimulatorReport::confirmed(const storage::EquipmentName& equipment,
                                std::int64_t version) const {
  if (json_) {
    say(Json{{"event", "confirmed"},
             {"spacecraft", equipment.spacecraft},
             {"equipment", equipment.equipment},
             {"version", version}}
            .dump());
    return;
  }
  say(fmt::format("{}/{} v{}: confirmed by the service", equipment.spacecraft, equipment.equipment,
                  version));
}

void SimulatorReport::refused(const ModelSubscriber::Refusal& refusal) const {
  if (json_) {
    say(Json{{"event", "refused"},
             {"spacecraft", refusal.equipment.spacecraft},
             {"equipment", refusal.equipment.equipment},
             {"version", refusal.version},
             {"reason", refusal.reason}}
            .dump(-1, ' ', false, Json::error_handler_t::replace));
    return;
  }
  say(fmt::format("{}/{} v{}: refused, {}", refusal.equipment.spacecraft,
                  refusal.equipment.equipment, refusal.version, refusal.reason));
}

void SimulatorReport::unpublished(const storage::EquipmentName& equipment,
                                  const std::string& text) const {
  if (json_) {
    say(Json{{"event", "unpublished"},
             {"spacecraft", equipment.spacecraft},
             {"equipment", equipment.equipment},
             {"reason", text}}
            .dump(-1, ' ', false, Json::error_handler_t::replace));
    return;
  }
  say(text);
}

void SimulatorReport::cache_fault(const CacheFault& fault) const {
  if (json_) {
    say(Json{{"event", "cache"},
             {"spacecraft", fault.equipment.spacecraft},
             {"equipment", fault.equipment.equipment},
             {"reason", fault.reason}}
            .dump(-1, ' ', false, Json::error_handler_t::replace));
    return;
  }
  say("last good versions: " + fault.reason);
}

void SimulatorReport::running(const storage::EquipmentName& equipment, const LiveEquipment& live,
                              bool final) const {
  const identification::Score score = live.score();
  const std::vector<std::string> missing = live.tracker().undescribed();
  if (json_) {
    say(Json{{"event", final ? "finished" : "running"},
             {"spacecraft", equipment.spacecraft},
             {"equipment", equipment.equipment},
             {"version", live.version().number},
             {"mode", live.is_following() ? "following" : "free"},
             {"ticks", score.rows},
             {"mrse_percent", to_json(score.mrse_percent)},
             {"fit_percent", to_json(score.fit_percent)},
             {"ticks_outside", live.ticks_outside()},
             {"gaps", live.gaps()},
             {"late_samples", live.tracker().counters().late},
             {"clock_jumps", live.tracker().counters().clock_jumps},
             {"undescribed", missing}}
            .dump());
    return;
  }
  const std::string state =
      !missing.empty()  ? "waits for the descriptors of " + list(missing)
      : score.rows == 0 ? std::string("waits for telemetry of its inputs and outputs")
                        : fmt::format(
                              "{} ticks{}, running MRSE {:.3f} %, fit {:.1f} %, {} "
                              "outside the identified range, {} gaps",
                              score.rows, live.is_following() ? " following the satellite" : "",
                              score.mrse(), score.fit(), live.ticks_outside(), live.gaps());
  say(fmt::format("{}/{} v{}{}: {}", equipment.spacecraft, equipment.equipment,
                  live.version().number, final ? " (ended)" : "", state));
}

}  // namespace reident
