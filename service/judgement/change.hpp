// The last change of the equipment, in the champion's record: its errors have grown for good.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identification/numerics/matrix.hpp"
#include "identification/statistics/change_detection.hpp"
#include "service/windows/block_reader.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

struct Change {
  storage::Time since = 0;  // begin of the first block that it may lie in
  storage::Time found = 0;  // end of the block with which it was found
};

/// Finds growth of the logarithms of a run's errors, each beside what its phase of the cycle and
/// the size of the outputs let expect. A block whose outputs are as small as their sensors' noise
/// says nothing.
class ChangeFinder {
 public:
  /// Takes in the next block that counts. Errors are measured against those of the first cycles,
  /// and behind a change against those of the first cycles behind it.
  void add(const storage::Block& block, const storage::BlockScore& score);
  const std::optional<Change>& last() const { return last_; }

 private:
  struct Entry {
    std::size_t phase;
    double log_error, log_size, weight;
  };
  using Terms = Eigen::Matrix<double, blocks_of_cycle + 1, 1>;
  Terms terms_of(const Entry& entry) const;
  void measure_reference();
  double scaled(const Entry& entry) const;

  std::vector<Entry> reference_;
  double reference_weight_ = 0;
  // What the reference lets expect.
  double mean_error_ = 0, mean_size_ = 0, least_size_ = 0, largest_size_ = 0;
  Terms coefficients_ = Terms::Zero();
  double scale_ = 1;
  std::optional<identification::ChangeDetector> detector_;
  std::optional<storage::Time> calm_until_;
  std::optional<Change> last_;
};

}  // namespace reident
