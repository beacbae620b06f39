// Whether one run errs less than another on the same rows, and how sure that is.
//
// The figure is the reduction of the MRSE, 1 - M_c / M_i with M = sum over outputs of
// ||e_q|| / ||y_q|| of the candidate and the incumbent. Both runs meet the same inputs and the same
// disturbances, so that most of the chance in the two errors is common: it is the pair that is
// resampled. The logarithm phi = log M_i - log M_c is nearly normal where the ratio is skewed; its
// variance is that of the delete-one jackknife over blocks of consecutive rows (H. R. Kuensch,
// Annals of Statistics 17(3), 1989), blocks as long as error_confidence.hpp takes them for the
// correlation of what each row adds to phi. Blocks that are alike beside each other say less than
// their number: with a correlation r > 0 of neighbours the variance grows by (1 + r) / (1 - r). The
// lower bound is phi - t s, t Student's quantile of as many degrees as blocks less one.
//
// A sensor that is stuck for a while can make any model look better than another. The reduction
// must therefore hold without any single stretch of a twentieth of the rows: where it is smaller
// without one of them, that is the bound.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// What is supposed of the equipment while the rows were taken. Where it goes on changing, what the
/// blocks add to phi may rise with time: variance and correlation are then those about the line
/// through it, with a degree less, so that the rise is neither. Any advantage that comes late in
/// the rows profits from that, an unusual operation's too.
enum class Course { steady, changing };

struct PairedComparison {
  double reduction = 0;  // of the MRSE; 0.1 where it falls by a tenth
  double low = 0;        // lower bound of it, one-sided
  Index blocks = 0;
  Index block_rows = 0;
};

/// y and both runs are N x p; `stretches` cover the rows, without a gap in each. `confidence` in
/// (0.5, 1) is that of the bound. Deterministic; the cost is linear in the rows. Absent for fewer
/// than 50 rows, an output of zeros and errors that are not finite.
std::optional<PairedComparison> compare_runs(const Matrix& y, const Matrix& incumbent,
                                             const Matrix& candidate,
                                             const std::vector<RowRange>& stretches,
                                             double confidence, Course course);

/// The MRSE, in percent, that the noise of the sensors alone would give a run: were a run's errors
/// of consecutive rows independent of each other, half of their mean squared difference would be
/// their mean square (J. von Neumann, Annals of Mathematical Statistics 12(4), 1941). The usual
/// squared difference is taken (simulate.hpp), since what a model makes of a load step is no noise;
/// all else that changes from row to row counts as noise. Of an output that mostly stays from one
/// row to the next, as one whose samples are held, the rows count at which it does not. y and run
/// are N x p, N >= 1, and finite.
double noise_percent(const Matrix& y, const Matrix& run, const std::vector<RowRange>& stretches);

}  // namespace reident::identification
