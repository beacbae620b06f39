#include "service/judgement/league.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "identification/statistics/change_detection.hpp"
#include "service/windows/block_reader.hpp"

namespace reident {
namespace {

using identification::dependence;
using identification::Index;
using identification::log_wealth;
using identification::lower_mean;
using identification::ScoreSeries;
using identification::Vector;
using storage::Block;
using storage::BlockScore;
using storage::Time;

constexpr double largest_score = 1;
/// A block of which less is believed says nothing.
constexpr double least_believed = 0.5;
/// Blocks are of one regime where no end of an input's range is further away than this share of
/// the range that the champion has seen.
constexpr double regime_width = 0.5;
/// Cycles of the champion's record that a change is measured against.
constexpr int reference_cycles = 8;

bool counts(const Block& block) {
  return block.rows > 0 && block.believed >= least_believed;
}

/// Rows of a record by the begin of their block.
const BlockScore* find(const Member& member, Time begin) {
  const auto found =
      std::lower_bound(member.scores.begin(), member.scores.end(), begin,
                       [](const BlockScore& score, Time time) { return score.begin < time; });
  return found != member.scores.end() && found->begin == begin && found->rows > 0 ? &*found
                                                                                  : nullptr;
}

/// Mean error of a run over the last cycle, by output, with the block at `index` the last.
std::vector<double> cycle_mean(const League& league, const Member& member, std::size_t index) {
  std::vector<double> mean(league.blocks[index].output_mean.size(), 0);
  double rows = 0;
  for (std::size_t i = index + 1; i-- > 0 && index - i < blocks_of_cycle;) {
    const BlockScore* score = find(member, league.blocks[i].range.begin);
    if (!score || !counts(league.blocks[i])) continue;
    const auto weight = static_cast<double>(score->rows);
    for (std::size_t q = 0; q < mean.size(); ++q) mean[q] += weight * score->mean[q];
    rows += weight;
  }
  for (double& value : mean) value /= rows;
  return mean;
}

double root(double square, double least) {
  return std::sqrt(std::max(square, least));
}

/// By how much a mean square is below another, relative to the two: 0 where they are equal, 1 where
/// it is nothing beside the other, so that no block decides alone.
double below(double one, double other) {
  if (!std::isfinite(one)) return -1;
  if (!std::isfinite(other)) return 1;
  return (other - one) / (other + one);
}

/// The score of `one` against `other` on a block, from -1 to 1: the mean over the outputs. What is
/// below the noise of the sensors counts as noise. `offset`, where there is one, is taken from the
/// other's error.
double score_of(const BlockScore& one, const BlockScore& other,
                const std::vector<double>* offset = nullptr) {
  double sum = 0;
  for (std::size_t q = 0; q < one.square.size(); ++q) {
    const double noise = std::max(std::min(one.noise[q], other.noise[q]), 1e-300);
    double theirs = other.square[q];
    if (offset) theirs += (*offset)[q] * ((*offset)[q] - 2 * other.mean[q]);
    sum += below(std::max(one.square[q], noise), std::max(theirs, noise));
  }
  return sum / static_cast<double>(one.square.size());
}

/// Sums from which the MRSE over some blocks follows.
struct Sums {
  std::vector<double> error, y, y_square;
  double rows = 0;

  void add(const Block& block, const std::vector<double>& square) {
    error.resize(square.size(), 0);
    y.resize(square.size(), 0);
    y_square.resize(square.size(), 0);
    const auto weight = static_cast<double>(block.rows);
    for (std::size_t q = 0; q < square.size(); ++q) {
      error[q] += weight * square[q];
      y[q] += weight * block.output_mean[q];
      y_square[q] += weight * block.output_square[q];
    }
    rows += weight;
  }
  double mrse_percent() const {
    double sum = 0;
    for (std::size_t q = 0; q < error.size(); ++q) sum += std::sqrt(error[q] / y_square[q]);
    return error.empty() ? 0 : 100 * sum / static_cast<double>(error.size());
  }
  double mean_mrse_percent() const {
    double sum = 0;
    for (std::size_t q = 0; q < error.size(); ++q)
      sum += std::sqrt(std::max(0.0, 1 - y[q] * y[q] / rows / y_square[q]));
    return error.empty() ? 0 : 100 * sum / static_cast<double>(error.size());
  }
};

/// Number of the regime of each block that counts, -1 for others. A block is of the nearest regime
/// that is near enough, or begins one.
std::vector<int> regimes_of(const std::vector<Block>& blocks) {
  std::vector<double> low, high;
  for (const Block& block : blocks) {
    if (!counts(block)) continue;
    if (low.empty()) low = block.input_low, high = block.input_high;
    for (std::size_t i = 0; i < low.size(); ++i) {
      low[i] = std::min(low[i], block.input_low[i]);
      high[i] = std::max(high[i], block.input_high[i]);
    }
  }
  std::vector<const Block*> leaders;
  std::vector<int> regimes;
  for (const Block& block : blocks) {
    regimes.push_back(-1);
    if (!counts(block)) continue;
    double nearest = regime_width;
    for (std::size_t r = 0; r < leaders.size(); ++r) {
      double distance = 0;
      for (std::size_t i = 0; i < low.size(); ++i) {
        const double range = high[i] - low[i];
        if (!(range > 0)) continue;
        distance =
            std::max({distance, std::abs(block.input_low[i] - leaders[r]->input_low[i]) / range,
                      std::abs(block.input_high[i] - leaders[r]->input_high[i]) / range});
      }
      if (distance < nearest) nearest = distance, regimes.back() = static_cast<int>(r);
    }
    if (regimes.back() < 0) {
      regimes.back() = static_cast<int>(leaders.size());
      leaders.push_back(&block);
    }
  }
  return regimes;
}

struct Pair {
  std::vector<double> scores, without_offset;
  std::vector<int> regimes;
  Sums member, champion;
};

ScoreSeries series(const std::vector<double>& scores) {
  return {Eigen::Map<const Vector>(scores.data(), std::ssize(scores)), largest_score,
          blocks_of_cycle};
}

/// The score of an error that is less by the margin.
double margin_of(const EquipmentConfig& limits) {
  const double rest = 1 - limits.margin_percent / 100;
  return below(rest * rest, 1);
}

double error_probability(const EquipmentConfig& limits) {
  return 1 - limits.confidence_percent / 100;
}

/// Versions that were identified wholly behind the last change, or from the champion's window on,
/// come first: the k-th of them has a share 1 / (k (k + 1)) of three quarters of the error
/// probability. Of the rest the k-th has such a share of the last quarter, the newest first.
double log_threshold(const League& league, const Member& member, Time since,
                     const EquipmentConfig& limits) {
  constexpr double share_behind = 0.75;
  const bool is_behind = member.window.begin >= since;
  double k = 0;
  for (const storage::TimeRange& window : league.admitted)
    k += is_behind ? window.begin >= since && window.end <= member.window.end
                   : window.begin < since && window.end >= member.window.end;
  return std::log(std::max(1.0, k) * (k + 1) / error_probability(limits) /
                  (is_behind ? share_behind : 1 - share_behind));
}

Pair pair_of(const League& league, const std::vector<int>& regimes, const Member& member,
             Time since) {
  Pair pair;
  for (std::size_t i = 0; i < league.blocks.size(); ++i) {
    const Block& block = league.blocks[i];
    if (!counts(block) || block.range.begin < since) continue;
    const BlockScore* own = find(member, block.range.begin);
    const BlockScore* other = find(*league.champion, block.range.begin);
    if (!own || !other) continue;
    const std::vector<double> offset = cycle_mean(league, *league.champion, i);
    pair.scores.push_back(score_of(*own, *other));
    pair.without_offset.push_back(score_of(*own, *other, &offset));
    pair.regimes.push_back(regimes[i]);
    pair.member.add(block, own->square);
    pair.champion.add(block, other->square);
  }
  return pair;
}

/// Share of the champion's blocks that are in regimes which the member has not met.
double uncovered_share(const League& league, const std::vector<int>& regimes,
                       const Member& member) {
  std::map<int, std::pair<double, bool>> by_regime;  // champion's blocks; met by the member
  double all = 0;
  for (std::size_t i = 0; i < league.blocks.size(); ++i) {
    if (regimes[i] < 0) continue;
    auto& [served, met] = by_regime[regimes[i]];
    if (find(*league.champion, league.blocks[i].range.begin)) ++served, ++all;
    met = met || league.blocks[i].range.begin >= member.window.begin;
  }
  double uncovered = 0;
  for (const auto& [regime, of] : by_regime)
    if (!of.second) uncovered += of.first;
  return all > 0 ? uncovered / all : 0;
}

bool worse_in_a_regime(const Pair& pair, const EquipmentConfig& limits) {
  std::map<int, std::vector<double>> losses;
  for (std::size_t i = 0; i < pair.scores.size(); ++i)
    losses[pair.regimes[i]].push_back(-pair.scores[i]);
  const double threshold = std::log(static_cast<double>(losses.size()) / error_probability(limits));
  return std::any_of(losses.begin(), losses.end(), [&](const auto& of_regime) {
    const ScoreSeries loss = series(of_regime.second);
    return lower_mean(loss, dependence(loss), threshold) > margin_of(limits);
  });
}

/// R4: what a version errs, beside the mean of the outputs and the simulator's own model.
bool is_admissible(const Finding& finding, const EquipmentConfig& limits) {
  const double error = finding.mrse_percent;
  return std::isfinite(error) && error <= limits.max_mrse_percent &&
         error < finding.mean_mrse_percent;
}

bool beats_baseline(const Finding& finding, const EquipmentConfig& limits) {
  if (finding.baseline_mrse_percent > 0)
    return finding.mrse_percent < finding.baseline_mrse_percent;
  return !limits.baseline_mrse_percent || finding.mrse_percent < *limits.baseline_mrse_percent;
}

/// A first version has to be good on telemetry of a whole cycle.
Finding judge_first(const League& league, const Member& member, const EquipmentConfig& limits) {
  Finding finding;
  finding.version = member.version;
  Sums own, beside_baseline, baseline;
  for (const Block& block : league.blocks) {
    const BlockScore* score = counts(block) ? find(member, block.range.begin) : nullptr;
    if (!score) continue;
    ++finding.blocks;
    own.add(block, score->square);
    if (block.baseline_square.empty()) continue;
    baseline.add(block, block.baseline_square);
    beside_baseline.add(block, score->square);
  }
  finding.mrse_percent = own.mrse_percent();
  finding.mean_mrse_percent = own.mean_mrse_percent();
  finding.baseline_mrse_percent = baseline.mrse_percent();
  finding.recent_score = -finding.mrse_percent;
  const bool holds =
      finding.blocks >= blocks_of_cycle && is_admissible(finding, limits) &&
      (baseline.rows == 0 ? beats_baseline(finding, limits)
                          : beside_baseline.mrse_percent() < finding.baseline_mrse_percent);
  finding.obstacle = holds ? Obstacle::none : Obstacle::not_admissible;
  finding.log_wealth = -finding.mrse_percent;
  return finding;
}

Finding judge_against_champion(const League& league, const std::vector<int>& regimes,
                               const Member& member, Time since,
                               const EquipmentConfig& limits) {
  Finding finding;
  finding.version = member.version;
  const Pair pair = pair_of(league, regimes, member, since);
  finding.blocks = std::ssize(pair.scores);
  finding.log_threshold = log_threshold(league, member, since, limits);
  if (pair.scores.empty()) {
    finding.obstacle = Obstacle::not_better;
    return finding;
  }
  const ScoreSeries scores = series(pair.scores);
  finding.dependence = dependence(scores);
  finding.log_wealth = log_wealth(scores, finding.dependence, 0);
  finding.mean_score = scores.scores.mean();
  finding.mrse_percent = pair.member.mrse_percent();
  finding.champion_mrse_percent = pair.champion.mrse_percent();
  finding.mean_mrse_percent = pair.member.mean_mrse_percent();
  const Index recent = std::min<Index>(scores.scores.size(), 2 * blocks_of_cycle);
  finding.recent_score = scores.scores.tail(recent).mean();

  const double margin = margin_of(limits);
  finding.obstacle = [&] {
    if (!is_admissible(finding, limits)) return Obstacle::not_admissible;
    if (!(finding.log_wealth > finding.log_threshold)) return Obstacle::not_better;
    if (!(finding.mean_score > margin)) return Obstacle::within_margin;
    finding.lower_score = lower_mean(scores, finding.dependence, finding.log_threshold);
    finding.uncovered_share = uncovered_share(league, regimes, member);
    if (finding.lower_score * (1 - finding.uncovered_share) <
        largest_score * finding.uncovered_share)
      return Obstacle::not_covered;
    if (worse_in_a_regime(pair, limits)) return Obstacle::worse_in_regime;
    if (limits.unvouched == UnvouchedPolicy::wait && !league.unbound.empty()) {
      const ScoreSeries without = series(pair.without_offset);
      finding.mean_without_offset = without.scores.mean();
      finding.log_wealth_without_offset = log_wealth(without, dependence(without), 0);
      if (!(finding.log_wealth_without_offset > finding.log_threshold &&
            finding.mean_without_offset > margin))
        return Obstacle::bias_unverified;
    }
    if (member.window.end > league.champion->window.end &&
        member.window.end - league.champion->window.end < limits.min_interval)
      return Obstacle::too_soon;
    return Obstacle::none;
  }();
  return finding;
}

double log_error(const BlockScore& score) {
  double sum = 0;
  for (std::size_t q = 0; q < score.square.size(); ++q)
    sum += std::log(root(score.square[q], std::max(score.noise[q], 1e-300)));
  return sum / static_cast<double>(score.square.size());
}

/// Finds growth of the logarithms of a run's errors, each beside those of its phase of the cycle.
class GrowthDetector {
 public:
  /// Returns whether a change is found. It measures against the first cycles that it is given.
  bool add(std::size_t phase, double log_error) {
    if (!detector_) {
      reference_.push_back({phase, log_error});
      if (std::ssize(reference_) == reference_cycles * blocks_of_cycle) begin();
      return false;
    }
    return detector_->add(scaled(phase, log_error));
  }
  /// Whether nothing speaks for a change.
  bool is_calm() const { return !detector_ || detector_->statistic() == 0; }

 private:
  struct Entry {
    std::size_t phase;
    double log_error;
  };
  void begin() {
    std::array<double, blocks_of_cycle> counts{};
    for (const Entry& entry : reference_) {
      means_[entry.phase] += entry.log_error;
      ++counts[entry.phase];
    }
    for (std::size_t phase = 0; phase < means_.size(); ++phase)
      if (counts[phase] > 0) means_[phase] /= counts[phase];
    Vector left(std::ssize(reference_));
    for (Index i = 0; i < left.size(); ++i) {
      const Entry& entry = reference_[static_cast<std::size_t>(i)];
      left(i) = scaled(entry.phase, entry.log_error);
    }
    detector_.emplace(left);
    scale_ = 1 / std::sqrt(dependence({left, 1, 1}));
  }
  double scaled(std::size_t phase, double log_error) const {
    return scale_ * (log_error - means_[phase]);
  }

  std::vector<Entry> reference_;
  std::array<double, blocks_of_cycle> means_{};
  double scale_ = 1;
  std::optional<identification::ChangeDetector> detector_;
};

}  // namespace

std::optional<Change> change_of(const League& league) {
  if (!league.champion) return std::nullopt;
  std::optional<Change> change;
  GrowthDetector detector;
  Time since = INT64_MIN;
  for (const Block& block : league.blocks) {
    const BlockScore* score = counts(block) ? find(*league.champion, block.range.begin) : nullptr;
    if (!score) continue;
    const double error = log_error(*score);
    if (!std::isfinite(error)) continue;
    const Duration length = block.range.end - block.range.begin;
    const auto phase = static_cast<std::size_t>(block.range.begin / length % blocks_of_cycle);
    if (detector.add(phase, error)) {
      change = Change{since, block.range.end, 0};
      detector = {};
    } else if (detector.is_calm()) {
      since = block.range.end;
    }
  }
  return change;
}

std::vector<Finding> judge(const League& league, const EquipmentConfig& limits) {
  std::vector<Finding> findings;
  if (!league.champion) {
    for (const Member& member : league.challengers)
      findings.push_back(judge_first(league, member, limits));
    return findings;
  }
  const auto change = change_of(league);
  const Time since = change ? change->since : league.champion->window.begin;
  const std::vector<int> regimes = regimes_of(league.blocks);
  for (const Member& member : league.challengers)
    findings.push_back(judge_against_champion(league, regimes, member, since, limits));
  return findings;
}

std::optional<Finding> successor(const std::vector<Finding>& findings) {
  std::optional<Finding> best;
  for (const Finding& finding : findings)
    if (finding.obstacle == Obstacle::none && (!best || finding.recent_score > best->recent_score))
      best = finding;
  return best;
}

Finding weakest(const std::vector<Finding>& findings) {
  return *std::min_element(
      findings.begin(), findings.end(),
      [](const Finding& a, const Finding& b) { return a.log_wealth < b.log_wealth; });
}

}  // namespace reident
