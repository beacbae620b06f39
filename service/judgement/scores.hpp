// How one version's record compares with another's: scores of blocks, and errors over several.
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "identification/numerics/matrix.hpp"
#include "identification/statistics/betting.hpp"
#include "service/windows/block_reader.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

/// A version with its record.
struct Member {
  std::int64_t version = 0;
  storage::TimeRange window;
  storage::Time record = 0;  // begins here, with its validation part
  /// Ascending: its record, and before it what it erred on earlier blocks, if it ran there.
  std::vector<storage::BlockScore> scores;
};

/// Bound of a block's score.
inline constexpr double largest_score = 1;
/// What a sensor does by itself lies within so many deviations: its noise, and where its cycles go.
inline constexpr double deviations_of_sensor = 3;
/// Least square of an error where the sensor's noise is not known.
inline constexpr double least_square = 1e-300;

/// Blocks of a record that later ones are measured against.
inline constexpr std::size_t reference_blocks = identification::cycles_to_measure * blocks_of_cycle;

/// Place of the block in its cycle, from 0.
std::size_t phase_of(const storage::Block& block);

/// Whether anything is concluded from the block.
bool counts(const storage::Block& block);

/// The score of the block that begins there; null without one, or without rows.
const storage::BlockScore* find(const std::vector<storage::BlockScore>& scores,
                                storage::Time begin);
/// Likewise in the member's record.
inline const storage::BlockScore* find(const Member& member, storage::Time begin) {
  return begin < member.record ? nullptr : find(member.scores, begin);
}

/// Scores of one run against another, from -1 to 1: by how much its mean square is below the
/// other's, over that of both in the last cycle, and the mean over the outputs. A block in which
/// both err little counts little, and none decides alone.
class Scores {
 public:
  /// Mean squared errors of both runs on a block, by output.
  using Squares = std::vector<std::pair<double, double>>;

  /// Takes the next block in.
  void add(Squares squares);
  const std::vector<double>& values() const { return values_; }

 private:
  double score(std::size_t output) const;

  std::deque<Squares> cycle_;
  std::vector<double> values_;
};

/// Sums from which a run's errors over some blocks follow.
struct Sums {
  Eigen::ArrayXd error, y, y_square;  // by output
  double rows = 0;
  std::int64_t blocks = 0;

  void add(const storage::Block& block, const std::vector<double>& square, double weight = 1);
  /// 0 without a block.
  double mrse_percent() const;
  /// The worst output's.
  double fit_percent() const;
};

/// What two runs erred on the same blocks.
struct Comparison {
  std::vector<std::size_t> blocks;  // their places in the league
  Scores scores;
  Sums one, other;
  std::size_t seen = 0;  // blocks of the league that were looked at

  /// Takes in a block on which the other's mean squared errors are these, by output; what is below
  /// the noise of the sensors counts as noise. Without errors the block says nothing.
  void add(std::size_t place, const storage::Block& block, const storage::BlockScore& of_one,
           const storage::BlockScore& of_other, const std::vector<double>& square_of_other);
};

}  // namespace reident
