// Whether the errors of a run have grown for good, each beside what its phase of the operating
// cycle and the size of the outputs let expect (METHOD.md, section 16). Nothing here throws.
#pragma once

#include <optional>
#include <vector>

#include "identification/statistics/change_detection.hpp"

namespace reident::identification {

/// What a run erred on a part of an operating cycle.
struct BlockError {
  Index phase = 0;        // place in the cycle, from 0
  double log_error = 0;   // logarithms of root mean squares
  double log_output = 0;  // of the outputs
  double weight = 1;      // in [0, 1]: how much the block says
};

/// Judges blocks in the order of time. The reference are the first cycles; when a calm record has
/// doubled, it is all of the record.
class ErrorGrowth {
 public:
  /// A cycle has so many blocks.
  explicit ErrorGrowth(Index phases);
  /// Takes in the next block, whose logarithms are finite. Returns whether growth is found with it;
  /// nothing may be added then.
  bool add(const BlockError& block);
  /// Whether nothing speaks for growth since the last block.
  bool is_calm() const { return !detector_ || detector_->statistic() == 0; }
  /// Where growth was found: with how many of the last blocks it may have begun, at the most.
  Index blocks_since() const { return detector_->blocks_since(); }

 private:
  Vector terms_of(const BlockError& block) const;
  void measure_reference();
  double scaled(const BlockError& block) const;

  Index phases_;
  std::vector<BlockError> record_;
  double weight_ = 0;   // of the record
  double next_weight_;  // with which the reference is measured
  // What the reference lets expect.
  double mean_error_ = 0, mean_output_ = 0, least_output_ = 0, largest_output_ = 0;
  Vector coefficients_;
  double scale_ = 1;
  std::optional<ChangeDetector> detector_;
};

}  // namespace reident::identification
