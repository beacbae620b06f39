// What outputs show of the state at a segment's first row (METHOD.md, section 6). Users need
// `state_rows` alone. Requires well-formed models and segments of the record. Nothing here throws.
#pragma once

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Rows that a state is estimated from where there is no hurry: fewer leave noise in slow states.
constexpr Index state_rows = 500;

/// Returns C A^k, k = 0 ... count - 1, below each other (p count x n). Requires count >= 1.
Matrix observability_of(const StateSpaceModel& model, Index count);

/// Returns y[k] less the response from `x` (n) for the segment's first `count` rows, below each
/// other (p count). `x` becomes the state behind them.
Vector remainder_of(const StateSpaceModel& model, const Record& record, const Segment& segment,
                    Index count, Vector& x);

/// Returns the weight of each output (p): one over the root of the mean square of its errors (p),
/// which are at least 1e-10 of the output's size in `rows`.
Vector weights_of(const Vector& square_errors, const Record& record, const Segment& rows);

}  // namespace reident::identification
