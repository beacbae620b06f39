// Whether one run errs less than another on the same rows, and how certain that is (METHOD.md,
// section 15). Both runs have the same inputs and disturbances, so they are compared block by
// block. Nothing here throws.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// What is assumed of the equipment while the rows were taken. Where it goes on changing, an
/// advantage that rises with time is neither chance nor correlation; any late advantage profits.
enum class Stationarity { stationary, changing };

/// By how much the candidate errs less than the incumbent.
struct PairedComparison {
  double reduction = 0;  // of the MRSE; 0.1 where it falls by a tenth
  double low = 0;        // lower bound of it, one-sided
  Index blocks = 0;
  Index block_rows = 0;
};

/// Compares two runs. y and both runs are N x p; `segments` cover the rows, without a gap in each.
/// `confidence` in (0.5, 1) is that of the bound. Absent for fewer than 50 rows, an output of zeros
/// and errors that are not finite. The cost is linear in the rows.
std::optional<PairedComparison> compare_runs(const Matrix& y, const Matrix& incumbent,
                                             const Matrix& candidate,
                                             const std::vector<RowRange>& segments,
                                             double confidence, Stationarity stationarity);

/// Returns the MRSE, in percent, that the noise of the sensors alone would give a run: that of the
/// usual change of its errors from row to row. Where an output's samples are held, new ones count.
/// Requires finite y and run (N x p), N >= 1, and segments that cover the rows.
double noise_percent(const Matrix& y, const Matrix& run, const std::vector<RowRange>& segments);
/// Returns the same as a mean squared error, in the square of the output's unit (p).
Vector noise_squares(const Matrix& y, const Matrix& run, const std::vector<RowRange>& segments);

}  // namespace reident::identification
