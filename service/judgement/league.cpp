#include "service/judgement/league.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <map>

#include "identification/statistics/betting.hpp"
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
using Code = ReasonCode;

constexpr double largest_score = 1;
/// A block of which less is believed says nothing.
constexpr double least_believed = 0.5;
/// Blocks are of one regime where no end of an input's range is further away than this share of
/// the range that the champion has seen.
constexpr double regime_width = 0.25;
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

/// Mean squared errors of two runs on a block, by output. What is below the noise of the sensors
/// counts as noise.
struct Squares {
  std::vector<double> one, other;
};

/// `offset`, where there is one, is taken from the other's error.
Squares squares_of(const BlockScore& one, const BlockScore& other,
                   const std::vector<double>* offset = nullptr) {
  Squares squares;
  for (std::size_t q = 0; q < one.square.size(); ++q) {
    const double noise = std::max(std::min(one.noise[q], other.noise[q]), 1e-300);
    double theirs = other.square[q];
    if (offset) theirs += (*offset)[q] * ((*offset)[q] - 2 * other.mean[q]);
    squares.one.push_back(std::max(one.square[q], noise));
    squares.other.push_back(std::max(theirs, noise));
  }
  return squares;
}

/// Scores of one run against another, from -1 to 1: by how much its mean square is below the
/// other's, over that of both in the last cycle, and the mean over the outputs. A block in which
/// both err little counts little, and none decides alone.
class Scores {
 public:
  /// Takes the next block in.
  void add(Squares squares) {
    cycle_.push_back(std::move(squares));
    if (cycle_.size() > blocks_of_cycle) cycle_.pop_front();
    const std::size_t outputs = cycle_.back().one.size();
    double sum = 0;
    for (std::size_t q = 0; q < outputs; ++q) sum += score(q);
    values_.push_back(sum / static_cast<double>(outputs));
  }
  const std::vector<double>& values() const { return values_; }

 private:
  double score(std::size_t q) const {
    const double one = cycle_.back().one[q], other = cycle_.back().other[q];
    if (!std::isfinite(one)) return -largest_score;
    if (!std::isfinite(other)) return largest_score;
    double both = 0;
    for (const Squares& block : cycle_)
      if (std::isfinite(block.one[q] + block.other[q])) both += block.one[q] + block.other[q];
    return std::clamp((other - one) / both * static_cast<double>(cycle_.size()), -largest_score,
                      largest_score);
  }

  std::deque<Squares> cycle_;
  std::vector<double> values_;
};

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
  /// The worst output's.
  double fit_percent() const {
    double worst = 0;
    for (std::size_t q = 0; q < error.size(); ++q)
      worst = std::max(worst, std::sqrt(error[q] / (y_square[q] - y[q] * y[q] / rows)));
    return 100 * (1 - worst);
  }
};

/// Ranges of the inputs over the cycle that ends with each block; empty of a block that does not
/// count.
struct InputRange {
  std::vector<double> low, high;

  void widen(const std::vector<double>& other_low, const std::vector<double>& other_high) {
    if (low.empty()) low = other_low, high = other_high;
    for (std::size_t i = 0; i < low.size(); ++i) {
      low[i] = std::min(low[i], other_low[i]);
      high[i] = std::max(high[i], other_high[i]);
    }
  }
  /// Largest distance of an end from the other's, over the range of `all`.
  double distance(const InputRange& other, const InputRange& all) const {
    double largest = 0;
    for (std::size_t i = 0; i < low.size(); ++i)
      if (const double range = all.high[i] - all.low[i]; range > 0)
        largest = std::max({largest, std::abs(low[i] - other.low[i]) / range,
                            std::abs(high[i] - other.high[i]) / range});
    return largest;
  }
};

/// Number of the operating regime of each block that counts, -1 for others: cycles over which the
/// inputs have about the same ranges are of one regime. A block is of the nearest regime that is
/// near enough, or begins one.
std::vector<int> regimes_of(const std::vector<Block>& blocks) {
  std::vector<InputRange> cycles(blocks.size());
  InputRange all;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!counts(blocks[i])) continue;
    all.widen(blocks[i].input_low, blocks[i].input_high);
    for (std::size_t k = i + 1; k-- > 0 && i - k < blocks_of_cycle;)
      if (counts(blocks[k])) cycles[i].widen(blocks[k].input_low, blocks[k].input_high);
  }
  std::vector<const InputRange*> leaders;
  std::vector<int> regimes;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    regimes.push_back(-1);
    if (!counts(blocks[i])) continue;
    double nearest = regime_width;
    for (std::size_t r = 0; r < leaders.size(); ++r)
      if (const double distance = cycles[i].distance(*leaders[r], all); distance < nearest)
        nearest = distance, regimes.back() = static_cast<int>(r);
    if (regimes.back() < 0) {
      regimes.back() = static_cast<int>(leaders.size());
      leaders.push_back(&cycles[i]);
    }
  }
  return regimes;
}

struct Pair {
  std::vector<Time> begins;
  std::vector<double> scores, without_offset;
  std::vector<int> regimes;
  Sums member, champion;
};

ScoreSeries series(const std::vector<double>& scores, double assumed) {
  return {Eigen::Map<const Vector>(scores.data(), std::ssize(scores)), largest_score,
          blocks_of_cycle, assumed};
}

/// Dependence of the scores of the two members with the longest records: what is assumed of
/// versions whose records are short. 0 where there are no two.
double usual_dependence(const League& league) {
  std::vector<const Member*> members;
  for (const Member& member : league.challengers) members.push_back(&member);
  if (league.champion) members.push_back(&*league.champion);
  if (members.size() < 2) return 0;
  std::partial_sort(members.begin(), members.begin() + 2, members.end(),
                    [](const Member* a, const Member* b) {
                      return a->scores.size() > b->scores.size();
                    });
  Scores scores;
  for (const Block& block : league.blocks) {
    if (!counts(block)) continue;
    const BlockScore* one = find(*members[0], block.range.begin);
    const BlockScore* other = find(*members[1], block.range.begin);
    if (one && other) scores.add(squares_of(*one, *other));
  }
  return dependence(series(scores.values(), 0));
}

/// The score of an error that is less by the margin.
double margin_of(const EquipmentConfig& limits) {
  const double rest = 1 - limits.margin_percent / 100;
  return (1 - rest * rest) / (1 + rest * rest);
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
  Scores scores, without_offset;
  for (std::size_t i = 0; i < league.blocks.size(); ++i) {
    const Block& block = league.blocks[i];
    if (!counts(block) || block.range.begin < since) continue;
    const BlockScore* own = find(member, block.range.begin);
    const BlockScore* other = find(*league.champion, block.range.begin);
    if (!own || !other) continue;
    const std::vector<double> offset = cycle_mean(league, *league.champion, i);
    pair.begins.push_back(block.range.begin);
    scores.add(squares_of(*own, *other));
    without_offset.add(squares_of(*own, *other, &offset));
    pair.regimes.push_back(regimes[i]);
    pair.member.add(block, own->square);
    pair.champion.add(block, other->square);
  }
  pair.scores = scores.values();
  pair.without_offset = without_offset.values();
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

bool worse_in_a_regime(const Pair& pair, double assumed, const EquipmentConfig& limits) {
  std::map<int, std::vector<double>> losses;
  for (std::size_t i = 0; i < pair.scores.size(); ++i)
    losses[pair.regimes[i]].push_back(-pair.scores[i]);
  const double threshold = std::log(static_cast<double>(losses.size()) / error_probability(limits));
  return std::any_of(losses.begin(), losses.end(), [&](const auto& of_regime) {
    const ScoreSeries loss = series(of_regime.second, assumed);
    return lower_mean(loss, dependence(loss), threshold) > margin_of(limits);
  });
}

/// R4, on the record.
std::optional<Reason> inadmissible(const Finding& finding, const EquipmentConfig& limits) {
  if (!std::isfinite(finding.mrse_percent)) return because<Code::not_finite>();
  if (finding.mrse_percent > limits.max_mrse_percent)
    return because<Code::error_above_limit>(finding.mrse_percent, limits.max_mrse_percent);
  if (!(finding.fit_percent > 0)) return because<Code::not_better_than_mean>(finding.fit_percent);
  return std::nullopt;
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
  finding.fit_percent = own.fit_percent();
  finding.baseline_mrse_percent = baseline.mrse_percent();
  finding.recent_score = finding.log_wealth = -finding.mrse_percent;
  finding.obstacle = [&]() -> std::optional<Reason> {
    if (finding.blocks < blocks_of_cycle)
      return because<Code::too_few_blocks>(finding.blocks, std::int64_t{blocks_of_cycle});
    if (auto reason = inadmissible(finding, limits)) return reason;
    const double error =
        baseline.rows > 0 ? beside_baseline.mrse_percent() : finding.mrse_percent;
    const auto rival = baseline.rows > 0 ? finding.baseline_mrse_percent
                                         : limits.baseline_mrse_percent.value_or(INFINITY);
    if (!(error < rival)) return because<Code::not_better_than_simulator>(error, rival);
    return std::nullopt;
  }();
  return finding;
}

/// Where and by what a league is judged.
struct Standard {
  const League& league;
  const EquipmentConfig& limits;
  Time since;                // records count from here on
  std::vector<int> regimes;  // of the blocks
  double assumed;            // dependence of scores
};

/// R2. Uncovered blocks count as if they were lost entirely.
std::optional<Reason> unproved_somewhere(const Standard& standard, const Member& member,
                                         const Pair& pair, Finding& finding) {
  const std::int64_t champion = standard.league.champion->version;
  finding.uncovered_share = uncovered_share(standard.league, standard.regimes, member);
  if (finding.lower_score * (1 - finding.uncovered_share) <
      largest_score * finding.uncovered_share)
    return because<Code::not_covered>(champion, 100 * finding.uncovered_share);
  if (worse_in_a_regime(pair, standard.assumed, standard.limits))
    return because<Code::worse_in_regime>(champion);
  return std::nullopt;
}

/// R3.
std::optional<Reason> may_be_bias(const Standard& standard, const Pair& pair, Finding& finding) {
  const std::vector<std::string>& unbound = standard.league.unbound;
  if (standard.limits.bias == BiasPolicy::approve || unbound.empty()) return std::nullopt;
  const ScoreSeries without = series(pair.without_offset, standard.assumed);
  finding.mean_without_offset = without.scores.mean();
  finding.wealth_without_offset = log_wealth(without, dependence(without), 0);
  if (finding.wealth_without_offset > finding.log_threshold &&
      finding.mean_without_offset > margin_of(standard.limits))
    return std::nullopt;
  std::string sensors;
  for (const std::string& name : unbound) sensors += (sensors.empty() ? "" : ", ") + name;
  return because<Code::bias_unverified>(standard.league.champion->version, sensors);
}

/// R5.
std::optional<Reason> too_soon(const Standard& standard, const Member& member) {
  const Member& champion = *standard.league.champion;
  const Duration since = member.window.end - champion.window.end;
  if (since <= 0 || since >= standard.limits.min_interval) return std::nullopt;
  return because<Code::too_soon>(since, champion.version, standard.limits.min_interval);
}

Finding judge_against_champion(const Standard& standard, const Member& member) {
  const EquipmentConfig& limits = standard.limits;
  const std::int64_t champion = standard.league.champion->version;
  Finding finding;
  finding.version = member.version;
  const Pair pair = pair_of(standard.league, standard.regimes, member, standard.since);
  finding.blocks = std::ssize(pair.scores);
  finding.log_threshold = log_threshold(standard.league, member, standard.since, limits);
  const auto not_better = [&] {
    return because<Code::not_better>(champion, finding.mrse_percent, finding.champion_mrse_percent,
                                     finding.blocks, finding.log_wealth, finding.log_threshold);
  };
  if (pair.scores.empty()) {
    finding.obstacle = not_better();
    return finding;
  }
  const ScoreSeries scores = series(pair.scores, standard.assumed);
  finding.dependence = dependence(scores);
  finding.log_wealth = log_wealth(scores, finding.dependence, 0);
  finding.mean_score = scores.scores.mean();
  finding.mrse_percent = pair.member.mrse_percent();
  finding.fit_percent = pair.member.fit_percent();
  finding.champion_mrse_percent = pair.champion.mrse_percent();
  const Index recent = std::min<Index>(scores.scores.size(), 2 * blocks_of_cycle);
  finding.recent_score = scores.scores.tail(recent).mean();
  finding.obstacle = [&]() -> std::optional<Reason> {
    if (auto reason = inadmissible(finding, limits)) return reason;
    if (!(finding.log_wealth > finding.log_threshold)) return not_better();
    if (!(finding.mean_score > margin_of(limits)))
      return because<Code::within_margin>(champion, limits.margin_percent, finding.mrse_percent,
                                          finding.champion_mrse_percent, finding.blocks);
    finding.lower_score = lower_mean(scores, finding.dependence, finding.log_threshold);
    if (auto reason = unproved_somewhere(standard, member, pair, finding)) return reason;
    if (auto reason = may_be_bias(standard, pair, finding)) return reason;
    return too_soon(standard, member);
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
      change = Change{since, block.range.end};
      detector = {};
    } else if (detector.is_calm()) {
      since = block.range.end;
    }
  }
  return change;
}

namespace {

/// Records count from the last change on, or from the champion's window.
Time counted_since(const League& league) {
  const auto change = change_of(league);
  return change ? change->since : league.champion->window.begin;
}

}  // namespace

std::vector<Finding> judge(const League& league, const EquipmentConfig& limits) {
  std::vector<Finding> findings;
  if (!league.champion) {
    for (const Member& member : league.challengers)
      findings.push_back(judge_first(league, member, limits));
    return findings;
  }
  const Standard standard{league, limits, counted_since(league), regimes_of(league.blocks),
                          usual_dependence(league)};
  for (const Member& member : league.challengers)
    findings.push_back(judge_against_champion(standard, member));
  return findings;
}

std::optional<Finding> successor(const std::vector<Finding>& findings) {
  std::optional<Finding> best;
  for (const Finding& finding : findings)
    if (!finding.obstacle && (!best || finding.recent_score > best->recent_score)) best = finding;
  return best;
}

Finding weakest(const std::vector<Finding>& findings) {
  return *std::min_element(
      findings.begin(), findings.end(),
      [](const Finding& a, const Finding& b) { return a.log_wealth < b.log_wealth; });
}

std::vector<ComparedBlock> compared_blocks(const League& league, const Member& challenger,
                                           const EquipmentConfig& limits) {
  const Time since = counted_since(league);
  const Pair pair = pair_of(league, regimes_of(league.blocks), challenger, since);
  const double assumed = usual_dependence(league);
  const double threshold = log_threshold(league, challenger, since, limits);
  std::vector<ComparedBlock> blocks;
  std::vector<double> scores;
  for (std::size_t i = 0; i < pair.scores.size(); ++i) {
    scores.push_back(pair.scores[i]);
    const ScoreSeries found = series(scores, assumed);
    blocks.push_back({pair.begins[i], pair.scores[i], found.scores.mean(),
                      lower_mean(found, dependence(found), threshold)});
  }
  return blocks;
}

std::optional<Reason> failure_of(const League& league, const EquipmentConfig& limits) {
  if (!league.champion) return std::nullopt;
  const Time since = counted_since(league);
  std::vector<std::pair<const Block*, const BlockScore*>> record;
  std::vector<double> mean;
  double rows = 0;
  for (const Block& block : league.blocks) {
    if (!counts(block) || block.range.begin < since) continue;
    const BlockScore* score = find(*league.champion, block.range.begin);
    if (!score) continue;
    record.push_back({&block, score});
    mean.resize(block.output_mean.size(), 0);
    const auto weight = static_cast<double>(block.rows);
    for (std::size_t q = 0; q < mean.size(); ++q) mean[q] += weight * block.output_mean[q];
    rows += weight;
  }
  for (double& value : mean) value /= rows;
  // The rival's mean squared error on a block; empty where it is not known.
  const auto fails_beside =
      [&](const char* name,
          const std::function<std::vector<double>(const Block&)>& square) -> std::optional<Reason> {
    Scores scores;
    Sums own, other;
    for (const auto& [block, score] : record) {
      BlockScore rival = *score;
      rival.square = square(*block);
      if (rival.square.empty()) continue;
      scores.add(squares_of(rival, *score));
      own.add(*block, score->square);
      other.add(*block, rival.square);
    }
    const ScoreSeries found = series(scores.values(), 0);
    if (!(log_wealth(found, dependence(found), 0) > -std::log(error_probability(limits))))
      return std::nullopt;
    return because<Code::champion_failed>(league.champion->version, own.mrse_percent(),
                                          std::ssize(scores.values()), name, other.mrse_percent());
  };
  if (auto reason = fails_beside("a constant at the mean", [&](const Block& block) {
        std::vector<double> square = block.output_square;
        for (std::size_t q = 0; q < square.size(); ++q)
          square[q] += mean[q] * (mean[q] - 2 * block.output_mean[q]);
        return square;
      }))
    return reason;
  return fails_beside("the simulator's own model",
                      [](const Block& block) { return block.baseline_square; });
}

}  // namespace reident
