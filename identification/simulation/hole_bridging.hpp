// The state of a run behind a hole of the record (METHOD.md, section 6, "Free run through a hole").
//
// The run goes on through the hole with interpolated inputs. Their error makes the state uncertain;
// the outputs behind the hole correct it by least squares, with that uncertainty as the prior and
// the errors of the run as the noise. So slow states come from the run and fast ones from the
// outputs. A run that took more from the outputs would never show that it drifts.
//
// Models are well-formed; `before` and `after` are neighbouring segments of the record, of which
// each may be a part that ends, or begins, at the hole. Nothing here throws.
#pragma once

#include <cstdint>
#include <optional>

#include "identification/samples/record.hpp"
#include "identification/simulation/square_changes.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Returns the length of the hole in ticks.
std::int64_t ticks_between(const Segment& before, const Segment& after);

/// Whether a run goes on through the hole: it has at most 60 ticks, or at most as many as a
/// hundredth of the record's rows.
bool is_bridged(const Record& record, const Segment& before, const Segment& after);

/// A state (n) and a root L (n x n) of its covariance L L'.
struct UncertainState {
  Vector x;
  Matrix L;
};

/// Returns the state behind the hole from the state `x` (n) at its first tick. `changes` are those
/// of the inputs (m). L is zero where the covariance overflows.
UncertainState through_hole(const StateSpaceModel& model, const Record& record,
                            const Segment& before, const Segment& after, const Vector& x,
                            const SquareChanges& changes);

/// How uncertain a run is.
struct RunNoise {
  SquareChanges input_changes;  // m
  Vector square_errors;         // p, means over the run so far
};

/// Returns the state (n) at the first row of `after` of a run that has come to the state `x` (n) at
/// the tick behind `before`: that of through_hole(), corrected by the first `state_rows` outputs.
/// Absent where the hole is not bridged.
std::optional<Vector> state_after_hole(const StateSpaceModel& model, const Record& record,
                                       const Segment& before, const Segment& after, const Vector& x,
                                       const RunNoise& noise);

}  // namespace reident::identification
