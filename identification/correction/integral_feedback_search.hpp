// The gain of integral feedback, by pole placement of the loop of n + 2p states that tracking.hpp
// closes, and the search of the paper's section 3.3 for where its poles belong.
//
// The loop without feedback is [d; xi1; xi2] with the model's poles and 2p of 1. It can be moved
// where the inputs reach the model's modes and can hold each output apart from the others
// where they are held: where C (I - A)^-1 B + D has the rank p, which needs as many inputs as
// outputs.
#pragma once

#include <variant>

#include "identification/correction/pole_placement.hpp"
#include "identification/samples/record.hpp"
#include "identification/samples/verdict.hpp"
#include "identification/simulation/integral_feedback.hpp"
#include "identification/simulation/simulate.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

struct TrackingPlacement {
  TrackingGain gain;
  Poles uncontrollable;  // poles of the model that no input reaches and that stayed
};

/// The gain that gives the loop the n + 2p poles `wanted`, as in place_poles(). Outputs are
/// measured by `error_limit` (p, positive). The verdict no_gain where the loop cannot be moved
/// there or is not stable. Requires a stable, well-formed model.
std::variant<TrackingPlacement, Verdict> place_tracking_poles(const StateSpaceModel& model,
                                                              const Poles& wanted,
                                                              const Vector& error_limit);

struct TrackingSearch {
  TrackingGain gain;
  double scale = 1;          // of the model's poles, as in correction.hpp
  double tau_samples = 0;    // the 2p further poles are at exp(-1 / tau)
  Score free_run, tracking;  // over the same tuning rows, and never to be mixed
  Poles uncontrollable;
};

/// Tries the 21 scales 10^-1, 10^-0.9, ... 10^1 with tau of 1/4, 1/2, 1, ... 64 samples and takes
/// the pair of least MRSE of the tracked run over at most the first 5,000 rows of `tune`, which
/// start there: the loop forgets where it started. The 1,000 of them in which the outputs move most
/// choose 12 pairs.
/// error_limit is the span of each output over the rows `identify`. The verdict no_gain where
/// nothing can be placed or nothing lowers the error of the free run over the same rows by more
/// than 1 %. Requires a stable, well-formed model, finite rows, and neither range empty.
std::variant<TrackingSearch, Verdict> search_tracking(const StateSpaceModel& model,
                                                      const Record& record, RowRange identify,
                                                      RowRange tune);

}  // namespace reident::identification
