// What a model leaves unexplained on a range of rows, and how certain its error figure is
// (METHOD.md, section 11). Nothing here throws.
//
//   - The residuals of the one-step prediction are white where the model and its K hold all that
//     the past shows of the next output. Without K those of the free run are judged; they are white
//     only where all noise is that of the sensor.
//   - Either residual is uncorrelated with the inputs at positive lags where the path from the
//     inputs to the outputs is complete. Correlation at negative lags is feedback.
//   - The errors of predictions grow with the steps towards that of the free run. How fast shows
//     what correction by telemetry is worth.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/scores.hpp"
#include "identification/simulation/state_space.hpp"
#include "identification/statistics/correlation.hpp"
#include "identification/statistics/error_confidence.hpp"

namespace reident::identification {

/// Whether the residuals of one output are white, at the lags 1 to 25.
struct Whiteness {
  CorrelationSummary correlation;
  Portmanteau portmanteau;
};

/// Correlation of the residuals of one output with one input, at the lags -25 to 25.
struct InputCorrelation {
  Index input = 0;
  Index output = 0;
  CorrelationSummary correlation;
};

/// The errors of predictions so many steps ahead.
struct PredictionScore {
  Index steps = 0;
  Score score;
};

/// All figures are of the scored rows.
struct Diagnostics {
  Index rows = 0;                    // scored
  bool predicted = false;            // the model has K: figures of the prediction are there
  std::vector<Whiteness> whiteness;  // p; of the prediction's residuals, or else of the free run's
  /// By outputs, then inputs: those of the prediction's residuals, empty without K, and those of
  /// the free run's.
  std::vector<InputCorrelation> prediction_inputs;
  std::vector<InputCorrelation> free_run_inputs;
  /// 1, 2, 5, 10, 20, 50 and 100 steps, below the longest scored segment; empty without K.
  std::vector<PredictionScore> predictions;
  Score free_run;
  std::optional<ErrorInterval> interval;  // of the free run's error
  ErrorSpread spread;                     // of the free run's error
};

/// Runs the model over `run` as score_free_run() does, from `x0` (n) where it is given, and judges
/// the rows `scored`. Requires a stable, well-formed model of the record's channels, finite rows,
/// and `scored` to be a part of `run`, at least one row. Figures that the rows cannot give are
/// absent or empty. The cost is linear in the rows.
Diagnostics diagnose(const StateSpaceModel& model, const Record& record, RowRange run,
                     RowRange scored, const std::optional<Vector>& x0 = std::nullopt);

/// What inputs do about their means that is not linear in them: the square of one, its product with
/// its size, or the product of two.
struct Bend {
  Index input = 0;
  Index other = 0;  // `input` where it is of one alone
  CorrelationSummary correlation;
};

/// Returns for each output the bend that follows its residuals best, at the lags 0 to 25. An
/// equipment that saturates, has a dead zone, answers a square or a power shows it. An input of two
/// values has none of its own, and products are looked at with at most `most_products` inputs: with
/// no bend no lags are looked at. `y_hat` (N x p) is the free run over the rows `scored`.
inline constexpr Index most_products = 8;
std::vector<Bend> bends(const Record& record, RowRange scored, const Matrix& y_hat);

}  // namespace reident::identification
