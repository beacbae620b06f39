// The gain of integral feedback, by pole placement of the loop of n + 2p states that
// integral_feedback.hpp closes, and the search for where its poles belong (METHOD.md, section 14).
//
// The loop without feedback is [d; xi1; xi2] with the model's poles and 2p of 1. It can be moved
// where the inputs reach the model's modes and can hold each output apart from the others: where
// C (I - A)^-1 B + D has the rank p, which needs as many inputs as outputs. Nothing here throws.
#pragma once

#include <variant>

#include "identification/correction/pole_placement.hpp"
#include "identification/samples/record.hpp"
#include "identification/samples/verdict.hpp"
#include "identification/simulation/integral_feedback.hpp"
#include "identification/simulation/scores.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// A gain whose loop is stable.
struct TrackingPlacement {
  TrackingGain gain;
  Poles uncontrollable;  // poles of the model that no input reaches and that stayed
};

/// Returns the gain that gives the loop the n + 2p poles `wanted`, as place_poles() takes them,
/// with the given `error_limit` (p, output units). Requires a stable, well-formed model. Returns
/// the verdict no_gain where a limit is not positive, or the loop cannot be moved there or is not
/// stable.
std::variant<TrackingPlacement, Verdict> place_tracking_poles(const StateSpaceModel& model,
                                                              const Poles& wanted,
                                                              const Vector& error_limit);

/// The best of the gains that were tried.
struct TrackingSearch {
  TrackingGain gain;
  double scale = 1;          // of the model's poles, as scaled_pole() moves them
  double tau_samples = 0;    // the 2p further poles are at exp(-1 / tau)
  Score free_run, tracking;  // over the same tuning rows, and never to be mixed
  Poles uncontrollable;
};

/// Tries the 21 scales 10^-1, 10^-0.9, ... 10^1 with tau of 1/4, 1/2, 1, ... 64 samples. Returns
/// the pair of least MRSE of the tracked run over at most the first 5,000 rows of `tune`; the 1,000
/// of them in which the outputs move most choose 12 pairs. error_limit is the span of each output
/// over the rows `identify`. Requires a stable, well-formed model, finite rows, and neither range
/// empty. Returns the verdict no_gain where nothing can be placed, or nothing lowers the error of
/// the free run over the same rows by more than 1 %.
std::variant<TrackingSearch, Verdict> search_tracking(const StateSpaceModel& model,
                                                      const Record& record, RowRange identify,
                                                      RowRange tune);

}  // namespace reident::identification
