// Ends of a sensor's or of an equipment's range at which an output stands while its inputs lead
// beyond. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// The rows, ascending, at which an output has its greatest or its least value.
struct Limit {
  bool is_greatest = false;
  double value = 0;
  std::vector<Index> rows;
};

/// Returns the ends of the values (N) of an output that are limits: a model's output y_hat (N) is
/// beyond one by more than two deviations of its errors at other values in at least ten rows, and
/// in nine of ten of these the output has that value to the digit. They are at least a tenth of the
/// rows at the limit: one that inputs at rest lead to, as in eclipse, is none. More than a third of
/// all rows are how the equipment works. What the output would be is not known (J. Tobin,
/// "Estimation of relationships for limited dependent variables", Econometrica 26, 1958). For
/// analog outputs: a digital one is at an end all the time.
std::vector<Limit> limits_of(const Vector& values, const Vector& y_hat);

}  // namespace reident::identification
