#include "service/client/simulator_report.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/model/model_json.hpp"

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

}  // namespace

void SimulatorReport::adopted(const ModelVersion& version,
                              const std::optional<ModelRunner::Swap>& swap) const {
  const EquipmentModel& model = version.model;
  if (json_) {
    Json line{{"event", "adopted"},
              {"equipment", model.equipment},
              {"version", version.number},
              {"digest", version.digest},
              {"order", model.dynamics.order()},
              {"rollback", version.rollback},
              {"mrse_percent", to_json(model.validation.mrse_percent)},
              {"fit_percent", to_json(model.validation.fit_percent)}};
    if (swap) {
      line["output_change"] = swap->largest;
      line["transition_ticks"] = swap->transition;
    }
    say(line.dump());
    return;
  }
  say(fmt::format("{} v{}: {}, order {}, on unseen data MRSE {:.3f} %, fit {:.1f} %{}",
                  model.equipment, version.number, version.rollback ? "rolled back to" : "adopted",
                  model.dynamics.order(), model.validation.mrse(), model.validation.fit(),
                  swap ? fmt::format(", output changes by {:.3g} over {} ticks", swap->largest,
                                     swap->transition)
                       : ""));
}

void SimulatorReport::refused(const ModelSubscriber::Refusal& refusal) const {
  if (json_) {
    say(Json{{"event", "refused"},
             {"equipment", refusal.equipment},
             {"version", refusal.version},
             {"reason", refusal.reason}}
            .dump());
    return;
  }
  say(fmt::format("{} v{}: refused, {}", refusal.equipment, refusal.version, refusal.reason));
}

void SimulatorReport::running(const std::string& equipment, const LiveEquipment& live,
                              bool final) const {
  const identification::Score score = live.score();
  const std::vector<std::string> missing = live.tracker().undescribed();
  if (json_) {
    say(Json{{"event", final ? "finished" : "running"},
             {"equipment", equipment},
             {"version", live.version().number},
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
      !missing.empty() ? "waits for the descriptors of " + list(missing)
      : score.rows == 0
          ? std::string("waits for telemetry of its inputs and outputs")
          : fmt::format(
                "{} ticks, running MRSE {:.3f} %, fit {:.1f} %, {} "
                "outside the identified range, {} gaps",
                score.rows, score.mrse(), score.fit(), live.ticks_outside(), live.gaps());
  say(fmt::format("{} v{}{}: {}", equipment, live.version().number, final ? " (ended)" : "",
                  state));
}

}  // namespace reident
