// Makes the errors of an output white, for fits that weigh them by what is known of them
// (METHOD.md, section 7, "Parsimony"). Private to the library. Nothing here throws.
#pragma once

#include "identification/statistics/autoregression.hpp"

namespace reident::identification {

/// Makes the rows of one output, regressors and target alike, those of errors that are white and of
/// deviation 1. The first rows of a segment are predicted by lower orders.
class Whitener {
 public:
  explicit Whitener(const ErrorColour& colour) : colour_(colour) {}
  void begin_segment();
  /// Returns the next rows of the segment, a column a time.
  Matrix white(const Eigen::Ref<const Matrix>& values);

 private:
  const ErrorColour& colour_;  // outlives it
  Matrix latest_;              // columns, the latest last
};

}  // namespace reident::identification
