#include "service/operations/league_keeper.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "service/judgement/member_run.hpp"
#include "service/model/model_json.hpp"
#include "service/model/reasons.hpp"
#include "service/support/floor_divide.hpp"
#include "service/windows/provenance.hpp"

namespace reident {
namespace {

using nlohmann::ordered_json;
using storage::DecisionKind;
using storage::Time;

storage::NewDecision decision_of(DecisionKind kind, const Finding& finding, std::string reason) {
  const ordered_json evidence = {{"blocks", finding.blocks},
                                 {"dependence", finding.dependence},
                                 {"log_wealth", finding.log_wealth},
                                 {"log_threshold", finding.log_threshold},
                                 {"mean_score", finding.mean_score},
                                 {"lower_score", finding.lower_score},
                                 {"mean_without_offset", finding.mean_without_offset},
                                 {"uncovered_share", finding.uncovered_share},
                                 {"mrse_percent", finding.mrse_percent},
                                 {"champion_mrse_percent", finding.champion_mrse_percent},
                                 {"mean_mrse_percent", finding.mean_mrse_percent},
                                 {"obstacle", static_cast<int>(finding.obstacle)}};
  return {kind, "gate", std::move(reason),
          evidence.dump(-1, ' ', false, ordered_json::error_handler_t::replace)};
}

}  // namespace

LeagueKeeper::LeagueKeeper(std::string spacecraft, const EquipmentConfig& equipment)
    : spacecraft_(std::move(spacecraft)), equipment_(equipment), reader_(spacecraft_, equipment) {
  league_.unbound = parameters_of(equipment);
  for (const Relation& relation : equipment.relations)
    for (const std::string& parameter : parameters_of(relation))
      std::erase(league_.unbound, parameter);
}

void LeagueKeeper::forget(storage::TimeRange range) {
  reader_.forget(range);
  samples_.clear();
}

void LeagueKeeper::read_members(const storage::Registry& registry) {
  const storage::DecisionState standing = registry.decision_state(spacecraft_, equipment_.name);
  if (standing_ == standing) return;
  if (!standing_) {
    league_.blocks = registry.blocks(spacecraft_, equipment_.name, INT64_MIN);
    if (!league_.blocks.empty()) reached_ = league_.blocks.back().range.end;
  }
  std::map<std::int64_t, Member> known;
  for (Member& member : std::exchange(league_.challengers, {}))
    known.emplace(member.version, std::move(member));
  if (league_.champion) {
    const std::int64_t number = league_.champion->version;
    known.emplace(number, std::move(*std::exchange(league_.champion, {})));
  }
  const std::map<std::int64_t, EquipmentModel> models = std::exchange(models_, {});
  // Absent where it cannot be run on this telemetry.
  const auto member_of = [&](std::int64_t number) -> std::optional<Member> {
    if (const auto found = known.find(number); found != known.end()) {
      models_.emplace(number, models.at(number));
      return std::move(found->second);
    }
    const auto version = registry.version(spacecraft_, equipment_.name, number);
    if (!version || mistake_in(*version)) return std::nullopt;
    EquipmentModel model = equipment_model_from_json(version->model_json);
    if (request_of(model) != reader_.request()) return std::nullopt;
    models_.emplace(number, std::move(model));
    return Member{number, version->window,
                  registry.scores(spacecraft_, equipment_.name, number, INT64_MIN)};
  };
  std::int64_t champion = 0, before = 0;
  league_.champion_since = INT64_MIN;
  if (const auto made = registry.champion_decision(spacecraft_, equipment_.name)) {
    champion = made->version;
    league_.champion = member_of(champion);
    const ordered_json evidence = ordered_json::parse(made->evidence_json, nullptr, false);
    if (evidence.is_object() && evidence.contains("until_ns"))
      league_.champion_since = evidence["until_ns"].get<Time>();
  }
  for (const storage::Decision& decision : registry.decisions(spacecraft_, equipment_.name))
    if ((decision.kind == DecisionKind::approve || decision.kind == DecisionKind::roll_back) &&
        decision.version != champion)
      before = decision.version;
  // The champion before may be the better one again, as when a change is undone.
  if (before != 0 && registry.version(spacecraft_, equipment_.name, before)->status == "superseded")
    if (auto member = member_of(before)) league_.challengers.push_back(*std::move(member));
  for (const std::int64_t number : registry.undecided(spacecraft_, equipment_.name, "on_probation"))
    if (auto member = member_of(number)) league_.challengers.push_back(*std::move(member));
  league_.admitted = registry.windows(spacecraft_, equipment_.name, "on_probation");
  standing_ = standing;
}

const BlockSamples& LeagueKeeper::samples_of(const storage::Archive& archive, Time begin) {
  const auto found = samples_.find(begin);
  if (found != samples_.end()) return found->second;
  BlockSamples samples = reader_.read(archive, begin);
  const auto kept = static_cast<std::size_t>(equipment_.window / reader_.length()) + 2;
  while (samples_.size() >= kept && samples_.begin()->first < begin)
    samples_.erase(samples_.begin());
  return samples_.emplace(begin, std::move(samples)).first->second;
}

void LeagueKeeper::catch_up(const storage::Archive& archive, Member& member, Time end,
                            std::vector<storage::BlockScore>& scores) {
  const Duration length = reader_.length();
  const EquipmentModel& model = models_.at(member.version);
  storage::RunState state;
  Time begin;
  if (member.scores.empty()) {
    begin = -floor_divide(-model.validated_on.begin, length) * length;
    // The run begins a block earlier, on telemetry that the version was fitted to.
    state = score_block(model, member.version, samples_of(archive, begin - length), {}).state;
  } else {
    begin = member.scores.back().begin + length;
    state = member.scores.back().state;
  }
  for (; begin + length <= end; begin += length) {
    storage::BlockScore score =
        score_block(model, member.version, samples_of(archive, begin), state);
    state = score.state;
    member.scores.push_back(score);
    scores.push_back(std::move(score));
  }
}

void LeagueKeeper::decide(const storage::Registry& registry, const LeagueWriter& writer, Time now) {
  if (league_.challengers.empty() || equipment_.approval == ApprovalPolicy::by_hand ||
      registry.hold(spacecraft_, equipment_.name))
    return;
  const std::vector<Finding> findings = judge(league_, equipment_);
  const auto apply = [&](const Finding& finding, DecisionKind kind, const std::string& reason) {
    storage::NewDecision decision = decision_of(kind, finding, reason);
    ordered_json evidence = ordered_json::parse(decision.evidence_json);
    evidence["until_ns"] = now;
    decision.evidence_json = evidence.dump();
    writer.decide(*standing_, {*registry.version(spacecraft_, equipment_.name, finding.version),
                               std::move(decision)});
  };
  const auto is_waiting = [&](const Finding& finding) {
    return registry.version(spacecraft_, equipment_.name, finding.version)->status == "waiting";
  };
  if (const auto found = successor(findings)) {
    apply(*found, is_waiting(*found) ? DecisionKind::approve : DecisionKind::roll_back, "better");
  } else {
    std::vector<Finding> waiting;
    std::copy_if(findings.begin(), findings.end(), std::back_inserter(waiting), is_waiting);
    if (std::ssize(waiting) > equipment_.members)
      apply(weakest(waiting), DecisionKind::reject, "weakest");
  }
  read_members(registry);
}

std::optional<Change> LeagueKeeper::advance(const storage::Archive& archive,
                                            const storage::Registry& registry, Time reached,
                                            const LeagueWriter& writer) {
  read_members(registry);
  std::optional<Change> found;
  const Duration length = reader_.length();
  const auto scored = [&](const std::optional<storage::Block>& block, Time end) {
    std::vector<storage::BlockScore> scores;
    if (league_.champion) catch_up(archive, *league_.champion, end, scores);
    for (Member& member : league_.challengers) catch_up(archive, member, end, scores);
    if (block || !scores.empty()) writer.scores(block, scores);
  };
  if (!reached_) {  // blocks begin with the first version's record
    if (league_.challengers.empty()) return found;
    const Time first = models_.at(league_.challengers.front().version).identified_from.begin;
    reached_ = floor_divide(first, length) * length;
  } else {
    scored(std::nullopt, *reached_);
    decide(registry, writer, *reached_);
  }
  for (; *reached_ + length <= reached; *reached_ += length) {
    const storage::Block block = samples_of(archive, *reached_).block;
    league_.blocks.push_back(block);
    scored(block, *reached_ + length);
    if (const auto change = change_of(league_); change && change->found == block.range.end)
      found = change;
    decide(registry, writer, block.range.end);
  }
  return found;
}

}  // namespace reident
