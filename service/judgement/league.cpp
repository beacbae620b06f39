#include "service/judgement/league.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

#include "identification/statistics/betting.hpp"
#include "service/judgement/coverage.hpp"
#include "service/judgement/league_rule.hpp"
#include "service/model/regime_inputs.hpp"

namespace reident {
namespace {

using storage::Block;
using storage::BlockScore;
using storage::Time;
using Code = ReasonCode;

/// Takes into `comparison` the blocks from `since` on, before `until`, that it has not seen.
void extend(Comparison& comparison, const League& league, const Member& one, const Member& other,
            Time since, Time until = INT64_MAX) {
  for_each_score(league, one, since, std::exchange(comparison.seen, league.blocks.size()),
                 [&](std::size_t i, const Block& block, const BlockScore& of_one) {
                   const BlockScore* of_other = find(other, block.range.begin);
                   if (of_other && block.range.begin < until)
                     comparison.add(i, block, of_one, *of_other, of_other->square);
                 });
}

}  // namespace

void Judge::take_in(const League& league) {
  if (champion_ != league.champion->version) {
    *this = Judge(*limits_);
    champion_ = league.champion->version;
  }
  std::size_t seen = std::exchange(seen_, league.blocks.size()), first = seen;
  while (regimes_.numbers().size() < league.blocks.size()) {
    const Block& block = league.blocks[regimes_.numbers().size()];
    identification::InputRanges ranges;
    if (counts(block)) ranges = {block.input_low, block.input_high};
    modes_.add(ranges.of(regime_places(ranges.low.size(), limits_->regime_inputs)));
    if (regimes_.add(std::move(ranges)))
      change_ = change_of_replaced_ = {}, first = 0;  // as where modes are others
  }
  const auto look_at = [&](const Member& member, ChangeFinder& changes) {
    for_each_score(league, member, INT64_MIN, first,
                   [&](std::size_t i, const Block& block, const BlockScore& score) {
                     changes.add(block, score, regimes_.numbers()[i], modes_.numbers()[i]);
                   });
  };
  look_at(*league.champion, change_);
  for (const Member& member : league.challengers)
    if (member.version == league.replaced) look_at(member, change_of_replaced_);
  const auto& change = change_.last();
  if (const Time since = change ? change->since : league.champion->window.begin; since != since_) {
    since_ = since;
    compared_ = {};
    seen = 0;
  }
  for_each_score(league, *league.champion, since_, seen,
                 [&](std::size_t i, const Block& block, const BlockScore& score) {
                   compared_.own.add(block, score.square);
                   compared_.with_simulator.add(i, block, score, score, block.baseline_square);
                 });
  const auto is_member = [&](std::int64_t version) {
    return version == champion_ ||
           std::ranges::count(league.challengers, version, &Member::version);
  };
  std::erase_if(compared_.pairs, [&](const auto& one) {
    return !is_member(one.first.first) || !is_member(one.first.second);
  });
}

const Comparison& Judge::comparison(const League& league, const Member& one, const Member& other) {
  Comparison& found = compared_.pairs[{one.version, other.version}];
  extend(found, league, one, other,
         one.version == league.replaced ? std::max(since_, league.replaced_at) : since_);
  return found;
}

/// Whichever is latest: the change in the champion's record, that in the record of the one that it
/// replaced, or that from before the champion was made.
Time Judge::changed(const League& league) const {
  Time latest = league.changed;
  for (const ChangeFinder* record : {&change_, &change_of_replaced_})
    if (record->last()) latest = std::max(latest, record->last()->since);
  return latest;
}

/// Dependence of the scores of the two members with the longest records, or of those from before
/// the last change: what is assumed of versions whose records are short. 0 where there are no two.
/// The one that the champion replaced is compared with it on too little.
double Judge::usual_dependence(const League& league) {
  std::vector<const Member*> members{&*league.champion};
  for (const Member& member : league.challengers)
    if (member.version != league.replaced) members.push_back(&member);
  if (members.size() < 2) return 0;
  std::ranges::partial_sort(members, members.begin() + 2, {},
                            [](const Member* member) { return member->window.end; });
  const Comparison& longest = comparison(league, *members[0], *members[1]);
  return std::max(bet_on(longest.scores.values(), 0).dependence(), dependence_before(league));
}

/// The largest dependence of the challengers' scores between the last change and the one before:
/// errors wander as they did. 0 where no record is that long.
double Judge::dependence_before(const League& league) {
  const auto& change = change_.last();
  if (!change) return 0;
  double largest = 0;
  for (const Member& member : league.challengers) {
    const auto [known, is_new] = compared_.dependence_before.try_emplace(member.version, 0);
    if (is_new) {
      Comparison compared;
      extend(compared, league, member, *league.champion, change->before, change->since);
      if (compared.blocks.size() >= reference_blocks)
        known->second = bet_on(compared.scores.values(), 0).dependence();
    }
    largest = std::max(largest, known->second);
  }
  return largest;
}

std::vector<Finding> Judge::findings(const League& league) {
  std::vector<Finding> findings;
  if (!league.champion) {
    for (const Member& member : league.challengers)
      findings.push_back(judge_first(league, member, *limits_));
    return findings;
  }
  take_in(league);
  const Standard standard{
      league, *limits_, since_, changed(league), usual_dependence(league), regimes_.numbers()};
  for (const Member& member : league.challengers)
    findings.push_back(
        judge_against_champion(standard, member, comparison(league, member, *league.champion)));
  return findings;
}

std::vector<Time> Judge::earlier_blocks(const League& league, const Member& member) {
  std::vector<Time> begins;
  if (!league.champion) {
    for (const Block& block : league.blocks)
      if (block.range.end > member.window.begin && block.range.begin < member.record)
        begins.push_back(block.range.begin);
    return begins;
  }
  take_in(league);
  return reident::earlier_blocks(league, regimes_.numbers(), member, changed(league));
}

std::optional<Change> Judge::change(const League& league) {
  if (!league.champion) return std::nullopt;
  take_in(league);
  return change_.last();
}

std::optional<Finding> successor(const std::vector<Finding>& findings) {
  std::optional<Finding> best;
  for (const Finding& finding : findings)
    if (!finding.obstacle && (!best || finding.recent_score > best->recent_score)) best = finding;
  return best;
}

bool is_proved(const Finding& finding) {
  return !finding.obstacle || finding.obstacle->code == Code::bias_unverified ||
         finding.obstacle->code == Code::too_soon;
}

Finding weakest(const std::vector<Finding>& findings) {
  const bool proved_stay = 2 * std::ranges::count_if(findings, is_proved) < std::ssize(findings);
  // Nothing but the last tells first versions apart where the simulator's own model sent nothing.
  return *std::ranges::min_element(findings, {}, [&](const Finding& finding) {
    return std::tuple(proved_stay && is_proved(finding), finding.mean_score, finding.recent_score);
  });
}

std::vector<ComparedBlock> Judge::compared_blocks(const League& league, const Member& challenger) {
  take_in(league);
  const Comparison& compared = comparison(league, challenger, *league.champion);
  const double assumed = usual_dependence(league);
  const double threshold = log_threshold(league, challenger, since_, *limits_);
  std::vector<ComparedBlock> blocks;
  std::vector<double> scores;
  for (std::size_t i = 0; i < compared.blocks.size(); ++i) {
    scores.push_back(compared.scores.values()[i]);
    const identification::Bet bet = bet_on(scores, assumed);
    blocks.push_back({league.blocks[compared.blocks[i]].range.begin, scores.back(),
                      bet.scores().mean(), bet.lower_mean(threshold)});
  }
  return blocks;
}

std::optional<Reason> Judge::failure(const League& league) {
  if (!league.champion) return std::nullopt;
  take_in(league);
  const auto fails_against = [&](const char* rival,
                                 const Comparison& compared) -> std::optional<Reason> {
    const double error = compared.one.mrse_percent(), theirs = compared.other.mrse_percent();
    if (error <= theirs) return std::nullopt;
    std::vector<double> losses = compared.scores.values();
    std::ranges::transform(losses, losses.begin(), std::negate<>());
    // A few great errors make the bet no richer, yet the model is of no use.
    const bool is_plain = compared.blocks.size() >= reference_blocks &&
                          error * (1 - limits_->margin_percent / 100) > theirs;
    if (!is_plain && !(bet_on(losses, 0).log_wealth() > -std::log(error_probability(*limits_))))
      return std::nullopt;
    return because<Code::champion_failed>(league.champion->version, error, losses.size(), rival,
                                          theirs);
  };
  if (const Sums& own = compared_.own; !(own.fit_percent() > 0)) {
    const Eigen::ArrayXd mean = own.y / own.rows;
    Comparison with_mean;
    for_each_score(league, *league.champion, since_, 0,
                   [&](std::size_t i, const Block& block, const BlockScore& score) {
                     std::vector<double> square = block.output_square;
                     for (std::size_t q = 0; q < square.size(); ++q)
                       square[q] += mean.data()[q] * (mean.data()[q] - 2 * block.output_mean[q]);
                     with_mean.add(i, block, score, score, square);
                   });
    if (auto reason = fails_against("a constant at the mean", with_mean)) return reason;
  }
  return fails_against("the simulator's own model", compared_.with_simulator);
}

}  // namespace reident
