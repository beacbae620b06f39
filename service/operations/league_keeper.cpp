#include "service/operations/league_keeper.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/model/model_json.hpp"
#include "service/model/reasons.hpp"
#include "service/support/floor_divide.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/member_run.hpp"
#include "service/windows/provenance.hpp"

namespace reident {
namespace {

using nlohmann::ordered_json;
using storage::DecisionKind;
using storage::Time;

constexpr const char* gate = "gate";  // as who decides

ordered_json to_json(const Finding& finding) {
  return {{"blocks", finding.blocks},
          {"dependence", finding.dependence},
          {"log_wealth", finding.log_wealth},
          {"log_threshold", finding.log_threshold},
          {"mean_score", finding.mean_score},
          {"lower_score", finding.lower_score},
          {"uncovered_share", finding.uncovered_share},
          {"over_regimes_mrse_percent", finding.over_regimes_mrse_percent.first},
          {"champion_over_regimes_mrse_percent", finding.over_regimes_mrse_percent.second},
          {"before_change_mrse_percent", finding.before_change_mrse_percent.first},
          {"champion_before_change_mrse_percent", finding.before_change_mrse_percent.second},
          {"log_wealth_without_offset", finding.wealth_without_offset},
          {"champion_mrse_without_offset_percent", finding.mrse_without_offset},
          {"mrse_percent", finding.mrse_percent},
          {"fit_percent", finding.fit_percent},
          {"champion_mrse_percent", finding.champion_mrse_percent},
          {"baseline_mrse_percent", finding.baseline_mrse_percent},
          {"changed_ns",
           finding.changed == INT64_MIN ? ordered_json() : ordered_json(finding.changed)}};
}

storage::NewDecision decision_of(DecisionKind kind, const std::vector<Reason>& reasons,
                                 ordered_json evidence) {
  evidence["reasons"] = to_json(reasons);
  return {kind, gate, sentences(reasons),
          evidence.dump(-1, ' ', false, ordered_json::error_handler_t::replace)};
}

/// Throws Error (corrupt) where a record is not of the model's size.
void require_fitting(std::int64_t version, const std::vector<storage::BlockScore>& scores,
                     const identification::StateSpaceModel& model) {
  for (const storage::BlockScore& score : scores)
    if ((score.rows > 0 && std::ssize(score.mean) != model.outputs()) ||
        (score.state.tick && std::ssize(score.state.x) != model.order()))
      throw storage::Error(storage::Error::Kind::corrupt,
                           fmt::format("the record of version {} is not of its model from {} on: "
                                       "restore a backup",
                                       version, time_text(score.begin)));
}

storage::TimeRange window_behind(const Change& change, const EquipmentConfig& equipment) {
  const Time begin = change.since + block_length(equipment);  // it may lie within its first block
  const Duration period = equipment.sample_period;
  const std::int64_t ticks = std::max(equipment.window / 2 / period, least_window_ticks(equipment));
  const Time end = std::max(change.found, begin + std::min(equipment.window, ticks * period));
  return {std::max(begin, end - equipment.window), end};
}

}  // namespace

void note_failure(storage::Registry& registry, const storage::EquipmentName& equipment,
                  const std::optional<Reason>& failure, Time now) {
  const std::string code(name(ReasonCode::champion_failed));
  if (failure)
    registry.raise({code, equipment, sentence(*failure), now});
  else
    registry.clear(code, equipment, now);
}

LeagueKeeper::LeagueKeeper(std::string spacecraft, const EquipmentConfig& equipment)
    : spacecraft_(std::move(spacecraft)),
      equipment_(equipment),
      reader_(spacecraft_, equipment),
      judge_(equipment) {
  league_.outputs = reader_.request().outputs;
  league_.biases = biases_of(reader_.request().inputs, reader_.request().derived);
}

void LeagueKeeper::forget(storage::TimeRange range) {
  reader_.forget(range);
  for (auto* samples : {&samples_, &earlier_samples_})
    std::erase_if(*samples, [&](const auto& kept) { return reader_.reads(kept.first, range); });
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
    std::vector<storage::BlockScore> scores =
        registry.scores(spacecraft_, equipment_.name, number, INT64_MIN);
    require_fitting(number, scores, model.dynamics);
    const Time record = models_.emplace(number, std::move(model)).first->second.validated_on.begin;
    return Member{number, version->window, record, std::move(scores)};
  };
  std::int64_t passed_over = 0;
  league_.replaced.reset();
  if (const auto made = registry.champion_decision(spacecraft_, equipment_.name)) {
    league_.champion = member_of(made->version);
    if (league_.champion)
      league_.changed = changed_in(*made).value_or(league_.champion->window.begin);
    if (made->actor == gate) {
      // The champion before may be the better one again, as when a change is undone.
      if (const auto before = registry.previous_champion(spacecraft_, equipment_.name))
        if (auto member = member_of(before->number)) {
          if (made->kind == DecisionKind::approve) league_.replaced = member->version;
          league_.replaced_at = judged_until(*made).value_or(INT64_MIN);
          league_.challengers.push_back(*std::move(member));
        }
    } else if (made->kind == DecisionKind::roll_back) {
      passed_over = made->id;  // the operator knew these versions, and chose another one
    }
  }
  waiting_.clear();
  for (const std::int64_t number : registry.waiting(
           spacecraft_, equipment_.name, std::string(name(Outcome::challenger)), passed_over))
    if (auto member = member_of(number)) {
      league_.challengers.push_back(*std::move(member));
      const storage::Decision last =
          registry.decisions(spacecraft_, equipment_.name, number).back();
      waiting_[number] = {waits_for_operator(last), {}};
      if (last.kind == DecisionKind::wait) waiting_[number].code = last_code(last);
    }
  league_.admitted =
      registry.windows(spacecraft_, equipment_.name, std::string(name(Outcome::challenger)));
  standing_ = standing;
}

const BlockSamples& LeagueKeeper::samples_of(const storage::Archive& archive, Time begin) {
  const auto found = samples_.find(begin);
  if (found != samples_.end()) return found->second;
  BlockSamples samples = reader_.read(archive, begin);
  // The record of a window's version begins with its validation part, and its run a block earlier.
  const auto validation = static_cast<double>(equipment_.window) * equipment_.validation_share;
  const auto kept =
      static_cast<std::size_t>(validation / static_cast<double>(reader_.length())) + 3;
  while (samples_.size() >= kept && samples_.begin()->first < begin)
    samples_.erase(samples_.begin());
  return samples_.emplace(begin, std::move(samples)).first->second;
}

void LeagueKeeper::catch_up(const storage::Archive& archive, Member& member, Time end,
                            std::vector<storage::BlockScore>& scores) {
  const Duration length = reader_.length();
  const EquipmentModel& model = models_.at(member.version);
  storage::RunState state;
  Time begin = std::max(-floor_divide(-member.record, length) * length,
                        league_.blocks.empty() ? INT64_MIN : league_.blocks.front().range.begin);
  if (begin + length > end) return;
  if (member.scores.empty()) run_earlier(archive, member, scores);
  if (member.scores.empty() || member.scores.back().begin < member.record) {
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

void LeagueKeeper::run_earlier(const storage::Archive& archive, Member& member,
                               std::vector<storage::BlockScore>& scores) {
  const Duration length = reader_.length();
  const EquipmentModel& model = models_.at(member.version);
  // The next member needs about the same ones.
  std::map<Time, BlockSamples> known = std::exchange(earlier_samples_, {});
  const auto samples_at = [&](Time begin) -> const BlockSamples& {
    if (auto node = known.extract(begin))
      return earlier_samples_.insert(std::move(node)).position->second;
    if (const auto found = earlier_samples_.find(begin); found != earlier_samples_.end())
      return found->second;
    return earlier_samples_.emplace(begin, reader_.read(archive, begin)).first->second;
  };
  for (const Time begin : judge_.earlier_blocks(league_, member)) {
    const bool goes_on = !member.scores.empty() && member.scores.back().begin + length == begin;
    const storage::RunState state =
        goes_on ? member.scores.back().state
                : score_block(model, member.version, samples_at(begin - length), {}).state;
    member.scores.push_back(score_block(model, member.version, samples_at(begin), state));
    scores.push_back(member.scores.back());
  }
}

bool LeagueKeeper::decide(const storage::Registry& registry, const LeagueWriter& writer,
                          const Finding& finding, DecisionKind kind,
                          const std::vector<Reason>& reasons, Time now) {
  auto version = *registry.version(spacecraft_, equipment_.name, finding.version);
  // A first version may be good enough on blocks of its own window.
  const Time until = std::max(now, version.window.end);
  ordered_json evidence = to_json(finding);
  evidence["until_ns"] = until;
  if (league_.champion) evidence["champion"] = league_.champion->version;
  return writer.decide(
      *standing_, {std::move(version), decision_of(kind, reasons, std::move(evidence)), until});
}

void LeagueKeeper::let_wait(const storage::Registry& registry, const LeagueWriter& writer,
                            const Finding& finding, const Reason& reason, Time now) {
  const auto& code = waiting_.at(finding.version).code;
  if (code && *code != name(reason.code))
    decide(registry, writer, finding, DecisionKind::wait, {reason}, now);
}

Reason LeagueKeeper::why_better(const Finding& finding) const {
  if (!league_.champion)
    return because<ReasonCode::first_version>(finding.mrse_percent, finding.fit_percent,
                                              finding.blocks);
  return because<ReasonCode::better>(finding.mrse_percent, finding.blocks,
                                     league_.champion->version, finding.champion_mrse_percent,
                                     finding.mean_score, finding.lower_score,
                                     equipment_.confidence_percent);
}

void LeagueKeeper::decide(const storage::Registry& registry, const LeagueWriter& writer, Time now) {
  const std::vector<Finding> findings = judge_.findings(league_);
  const auto is_waiting = [&](const Finding& finding) {
    return waiting_.contains(finding.version);
  };
  const auto hold = registry.hold(spacecraft_, equipment_.name);
  if (const auto found = successor(findings)) {
    const bool waits = is_waiting(*found);
    if (hold) {
      if (waits)
        let_wait(registry, writer, *found, because<ReasonCode::held>(hold->actor, hold->reason),
                 now);
    } else if (equipment_.approval == ApprovalPolicy::by_hand) {
      if (waits)
        let_wait(registry, writer, *found,
                 because<ReasonCode::waits_for_operator>(found->mrse_percent, found->blocks), now);
    } else {
      decide(registry, writer, *found, waits ? DecisionKind::approve : DecisionKind::roll_back,
             {why_better(*found)}, now);
      return read_members(registry);
    }
  }
  std::vector<Finding> waiting;
  std::copy_if(findings.begin(), findings.end(), std::back_inserter(waiting), is_waiting);
  for (const Finding& finding : waiting) {
    if (!finding.obstacle) continue;
    // It waits for an operator, or does so no more: its record does not speak for it now.
    const bool asks = finding.obstacle->code == ReasonCode::bias_unverified;
    if (asks || waiting_.at(finding.version).for_operator)
      let_wait(registry, writer, finding, *finding.obstacle, now);
  }
  if (std::ssize(waiting) > equipment_.members) {
    const Finding last = weakest(waiting);
    std::vector<Reason> reasons{because<ReasonCode::league_full>(equipment_.members)};
    if (last.obstacle && !is_proved(last)) reasons.push_back(*last.obstacle);
    decide(registry, writer, last, DecisionKind::reject, reasons, now);
  }
  look_after_champion(registry, writer, hold.has_value(), now);
  read_members(registry);
}

void LeagueKeeper::look_after_champion(const storage::Registry& registry,
                                       const LeagueWriter& writer, bool held, Time now) {
  const auto failure = judge_.failure(league_);
  const std::int64_t failed = failure ? league_.champion->version : 0;
  if (std::exchange(failed_, failed) != failed && writer.failure) writer.failure(failure);
  if (!failure || held || equipment_.on_failure == FailurePolicy::keep) return;
  Finding finding;
  finding.version = league_.champion->version;
  decide(registry, writer, finding, DecisionKind::withdraw, {*failure}, now);
}

std::optional<storage::TimeRange> LeagueKeeper::advance(const storage::Archive& archive,
                                                        const storage::Registry& registry,
                                                        Time reached, const LeagueWriter& writer) {
  read_members(registry);
  if (applying_.size() < equipment_.relations.size())
    applying_ = applying_relations(archive, spacecraft_, equipment_);
  league_.unbound = unbound_parameters(equipment_, applying_);
  const Duration length = reader_.length();
  const auto scored = [&](const std::optional<storage::Block>& block, Time end) {
    std::vector<storage::BlockScore> scores;
    if (league_.champion) catch_up(archive, *league_.champion, end, scores);
    for (Member& member : league_.challengers) catch_up(archive, member, end, scores);
    if (block || !scores.empty()) writer.scores(block, scores);
  };
  if (!reached_) {  // blocks begin with the first version's record
    if (league_.challengers.empty()) return std::nullopt;
    const Time first = models_.at(league_.challengers.front().version).identified_from.begin;
    reached_ = floor_divide(first, length) * length;
  } else {
    scored(std::nullopt, *reached_);
    decide(registry, writer, *reached_);
  }
  while (*reached_ + length <= reached) {
    const storage::Block block = samples_of(archive, *reached_).block;
    league_.blocks.push_back(block);
    *reached_ += length;
    scored(block, *reached_);
    const auto change = judge_.change(league_);
    const bool is_new = change && change->found == *reached_;
    if (is_new && writer.change)
      writer.change({league_.champion->version, change->since, change->found});
    decide(registry, writer, *reached_);
    if (is_new) return window_behind(*change, equipment_);
  }
  return std::nullopt;
}

}  // namespace reident
