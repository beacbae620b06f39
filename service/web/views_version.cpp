#include <algorithm>

#include <fmt/format.h>

#include "identification/numerics/decompositions.hpp"
#include "service/review/evidence.hpp"
#include "service/review/stored_league.hpp"
#include "service/review/verdict.hpp"
#include "service/web/questions.hpp"
#include "service/web/views.hpp"

namespace reident::web {
namespace {

constexpr std::size_t most_record_points = 1000;

Json poles_of(const identification::StateSpaceModel& model) {
  Json poles = Json::array();
  if (model.A.size() == 0) return poles;
  for (const auto& pole : identification::eigenvalues(model.A))
    poles.push_back({number_value(pole.real()), number_value(pole.imag())});
  return poles;
}

Json conditions_value(const Verdict& verdict) {
  Json list = Json::array();
  for (const Condition& condition : verdict.conditions)
    list.push_back({{"rule", condition.rule},
                    {"asked", condition.asked},
                    {"found", condition.found},
                    {"holds", condition.holds ? Json(*condition.holds) : Json()}});
  return list;
}

/// The record against the champion that the version is, or was, judged against. Of a long one the
/// newest points are as they are, and the others thinned out.
Json record_value(const Stored& stored, const StoredVersion& story) {
  const auto record = stored_record(stored.history, story);
  if (!record) return {};
  Json begin = Json::array(), score = Json::array(), mean = Json::array(), lower = Json::array();
  const auto blocks =
      Judge(record->limits).compared_blocks(record->league, record->member(story.version.number));
  const std::size_t step = blocks.size() / most_record_points + 1;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (i % step != 0 && i + step < blocks.size()) continue;
    begin.push_back(time_value(blocks[i].begin));
    score.push_back(number_value(blocks[i].score));
    mean.push_back(number_value(blocks[i].mean));
    lower.push_back(number_value(blocks[i].lower));
  }
  return {{"against", id_value(record->league.champion->version)},
          {"blocks", blocks.size()},
          {"change", record->change ? time_value(record->change->since) : Json()},
          {"begin", std::move(begin)},
          {"score", std::move(score)},
          {"mean", std::move(mean)},
          {"lower", std::move(lower)}};
}

Json signal_names_value(const std::vector<Signal>& signals) {
  Json list = Json::array();
  for (const Signal& signal : signals)
    list.push_back({{"name", signal.name}, {"unit", signal.unit}});
  return list;
}

}  // namespace

Json version_view(const Stored& stored, const HttpRequest& request) {
  const storage::EquipmentName name = equipment_of(stored, request);
  const StoredVersion story = version_of(stored, name, request);
  const Verdict verdict = verdict_of(stored.history, story);
  const auto champion = stored.history.champion_decision(name);
  Json view = name_value(name);
  view["version"] = id_value(story.version.number);
  view["status"] = story.version.status;
  view["asks_operator"] =
      std::ranges::any_of(stored.history.waiting(), [&](const history::WaitingRow& row) {
        return row.decision.version == story.version.number &&
               row.decision.equipment == name.equipment &&
               row.decision.spacecraft == name.spacecraft;
      });
  view["champion"] = champion ? id_value(champion->version) : Json();
  view["held"] = story.hold ? Json(story.hold->actor) : Json();
  view["verdict"] = verdict.sentence;
  view["conditions"] = conditions_value(verdict);
  view["window"] = range_value(story.version.window);
  view["identified_from"] = range_value(story.model.identified_from);
  view["validated_on"] = range_value(story.model.validated_on);
  view["trigger"] = story.attempt.trigger;
  view["outcome"] = story.attempt.outcome;
  view["reason"] = story.attempt.reason;
  view["method"] = story.model.method;
  view["order"] = story.model.dynamics.order();
  view["sample_period_s"] = story.model.dynamics.period_s;
  view["poles"] = poles_of(story.model.dynamics);
  view["inputs"] = signal_names_value(story.model.inputs);
  view["outputs"] = signal_names_value(story.model.outputs);
  view["digest"] = story.version.digest;
  view["digest_matches"] = story.digest_matches;
  view["evidence"] = evidence_of(story.attempt);
  view["record"] = record_value(stored, story);
  Json decisions = Json::array();
  for (const storage::Decision& decision : story.decisions)
    decisions.push_back({{"id", id_value(decision.id)},
                         {"time", time_value(decision.time)},
                         {"kind", storage::name(decision.kind)},
                         {"version", id_value(story.version.number)},
                         {"actor", decision.actor},
                         {"reason", decision.reason}});
  view["decisions"] = std::move(decisions);
  return view;
}

}  // namespace reident::web
