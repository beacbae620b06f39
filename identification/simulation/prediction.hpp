// Prediction by the innovations form: the model corrected by the measured outputs up to a row, and
// run from there on its inputs alone. It follows from the free run and its residual, without
// another run for each number of steps (METHOD.md, section 11, "Predictions"). Nothing throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::identification {

/// The predictions of a model over N rows, all of them from one free run.
class Predictor {
 public:
  /// Takes the free run `y_free` (N x p) of the model over the rows `run` of the record. Requires a
  /// well-formed model with K and finite rows. The cost is linear in the rows.
  Predictor(const StateSpaceModel& model, const Record& record, RowRange run, Matrix y_free);

  /// Returns the outputs (N x p) as predicted `steps` >= 1 rows before, from the outputs up to
  /// there. A row nearer than that to the start of its segment is predicted from the segment's
  /// initial state, so that predictions of any number of steps are of the same rows.
  Matrix outputs(Index steps) const;

 private:
  Matrix A_, C_;
  Matrix y_free_;
  Matrix d_;  // n x N: state of the innovations form less that of the free run
  std::vector<RowRange> segments_;
};

}  // namespace reident::identification
