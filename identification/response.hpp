// B, D, the operating point's remainder and the initial states of given A and C, by linear least
// squares on the simulated output.
#pragma once

#include <vector>

#include "identification/record.hpp"
#include "identification/state_space.hpp"

namespace reident::identification {

struct Response {
  StateSpaceModel model;  // A, C as given; B, D, y0 fitted; u0 zero; K empty
  Vector x0;              // state at the first row
};

/// Fits over `rows` of a normalised record. Requires a stable A.
///   y[k] = C A^k x0 + sum_{j<k} C A^(k-1-j) B u[j] + D u[k] + y0
/// is linear in B, D, y0 and one x0 for each segment.
Response fit_response(const Matrix& A, const Matrix& C, const Record& record, RowRange rows);

}  // namespace reident::identification
