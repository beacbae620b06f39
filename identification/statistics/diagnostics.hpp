// What a model leaves unexplained on a stretch of rows, and how sure its error figure is.
//
//   - The residuals of the one-step prediction (prediction.hpp) are white where the model and its K
//     hold all that the past says of the next output. Without K the free run's residuals are looked
//     at instead; they are white only where all noise is that of the sensor.
//   - Either residual is uncorrelated with the inputs at positive lags where the path from the
//   inputs
//     to the outputs is complete. The prediction residuals name the lag of what is missing, since
//     they are nearly white; the free run's judge that path whatever K is. Correlation at negative
//     lags is feedback from the outputs to the inputs.
//   - The errors of predictions grow with the steps towards the free run's: how fast tells what
//     correction by telemetry is worth.
//
// The tests are those of L. Ljung, "System Identification", 2nd edition, Prentice Hall, 1999,
// section 16.6, with the formulas of correlation.hpp; the interval is that of error_confidence.hpp.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/simulate.hpp"
#include "identification/simulation/state_space.hpp"
#include "identification/statistics/correlation.hpp"
#include "identification/statistics/error_confidence.hpp"

namespace reident::identification {

/// Of the residuals of one output, at the lags 1 to 25.
struct Whiteness {
  CorrelationSummary correlation;
  Portmanteau portmanteau;
};

/// Of the residuals of one output with one input, at the lags -25 to 25.
struct InputCorrelation {
  Index input = 0;
  Index output = 0;
  CorrelationSummary correlation;
};

struct PredictionScore {
  Index steps = 0;
  Score score;
};

struct Diagnostics {
  Index rows = 0;                    // scored
  bool predicted = false;            // the model has K: figures of the prediction are there
  std::vector<Whiteness> whiteness;  // p; of the prediction's residuals, or else of the free run's
  /// By outputs, then inputs. Of the prediction's residuals, empty without K; and of the free
  /// run's.
  std::vector<InputCorrelation> prediction_inputs;
  std::vector<InputCorrelation> free_run_inputs;
  /// Of 1, 2, 5, 10, 20, 50, 100 steps, below the longest scored segment; empty without K.
  std::vector<PredictionScore> predictions;
  Score free_run;
  std::optional<ErrorInterval> interval;  // of the free run's error
  ErrorSpread spread;                     // of the free run's error
};

/// Runs the model over `run` as score_free_run() does and looks at the rows of `scored`, at least
/// one and a part of `run`. The record is finite there and the model is stable. Segments never
/// speak to each other. The cost is linear in the rows.
Diagnostics diagnose(const StateSpaceModel& model, const Record& record, RowRange run,
                     RowRange scored, const std::optional<Vector>& x0 = std::nullopt);

}  // namespace reident::identification
