// The free run of a model over a record: a simulation on the inputs alone (METHOD.md, section 6).
#pragma once

#include <optional>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Returns the outputs (rows.size() x p) of the model driven by the record's inputs. It starts from
/// `x0` (n) where one is given, and else from estimate_initial_state(). It goes on through holes as
/// state_after_hole() says; behind a longer hole the state is estimated again.
/// Requires a well-formed model of the record's channels and rows within the record. Values may be
/// non-finite for an unstable model. Nothing throws.
Matrix free_run(const StateSpaceModel& model, const Record& record, RowRange rows,
                const std::optional<Vector>& x0 = std::nullopt);

}  // namespace reident::identification
