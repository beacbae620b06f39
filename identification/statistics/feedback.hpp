// Inputs that follow outputs: the record is of a closed loop (METHOD.md, section 20). Nothing here
// throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// An input that the past of an output predicts better than the past of all inputs does.
struct Feedback {
  Index input = 0;
  Index output = 0;
  double share = 0;  // of what the inputs' past leaves of the input, in (0, 1]
};

/// Tests each input against each output on `rows` with so many rows of past, by the likelihood
/// ratio of two regressions at 99.9 %. What the output explains must be at least 2 %: that is seen
/// where inputs and outputs share a rhythm longer than the past. Empty where there are too few
/// rows.
std::vector<Feedback> feedback_of(const Record& record, RowRange rows, Index past);

}  // namespace reident::identification
