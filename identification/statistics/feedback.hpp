// Inputs that follow outputs: the record is of a closed loop (METHOD.md, section 20). Nothing here
// throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// An input that the past of an output predicts better than inputs alone do.
struct Feedback {
  Index input = 0;
  Index output = 0;
  double share = 0;    // of what inputs alone leave of the input, in (0, 1]
  bool rises = false;  // with the output's newest row that is looked at
};

/// Tests each input against each output on `rows` with so many rows of past, by the likelihood
/// ratio of two regressions. Where no input follows any output, one is found with a probability of
/// at most 1e-3. `of_inputs` (record's rows x p) is what a model makes of the inputs alone: what
/// the output shows of inputs longer ago, such as a rhythm that they share, is no feedback. Nor is
/// what an input's own values a period ago tell. What the output explains must be at least 2 %. The
/// newest `unseen` rows of the outputs are not looked at. Empty where there are too few rows.
std::vector<Feedback> feedback_of(const Record& record, RowRange rows, Index past,
                                  const Matrix& of_inputs, Index unseen = 0);

}  // namespace reident::identification
