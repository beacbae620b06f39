// A model from records of a closed loop, where the inputs follow the outputs: subspace
// identification on an ARX model of high order (SSARX; M. Jansson, 13th IFAC SYSID, 2003). Past
// outputs stand among the regressors, so that inputs that depend on past noise make no bias, and
// the model may be unstable. METHOD.md, section 20. Private to the library. Nothing here throws.
#pragma once

#include <optional>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// Predicts rows from the rows before: y[t] = C x[t] + e[t], x[t+1] = A x[t] + B u[t] + K e[t].
/// An input acts on the outputs of the next row at the earliest: in a loop without a delay, D and
/// the controller cannot be told apart.
struct LoopModel {
  StateSpaceModel model;
  double log_variance = 0;  // of e: logarithm of the determinant of its covariance
};

/// Returns the logarithm of the determinant of the covariance of errors (p x rows) about zero;
/// absent where it is singular.
std::optional<double> log_variance(const Matrix& errors);

/// Identifies the model on `rows` of a record of normalised channels, with the order from
/// [1, max_order] that has the least BIC of its errors one row ahead. `past` rows, at least 2, are
/// in the ARX model. Absent where the rows do not determine it.
std::optional<LoopModel> loop_model(const Record& record, RowRange rows, Index past,
                                    Index max_order);

}  // namespace reident::identification
