// Centre and scale of the channels: the work is done on signals of mean 0 and deviation 1, so that
// neither units nor a large operating point decide how exact the sums and factors are.
#pragma once

#include <vector>

#include "identification/record.hpp"
#include "identification/state_space.hpp"

namespace reident::identification {

struct Normalisation {
  Vector u_mean, u_scale;      // m; scale 1 for a channel left out
  Vector y_mean, y_scale;      // p; scale 1 for a channel left out
  std::vector<Index> inputs;   // channels that take part, ascending
  std::vector<Index> outputs;  // channels that take part, ascending
};

/// Mean and standard deviation of every channel over `rows`. A channel takes part when it moves by
/// more than the rounding of its own size.
Normalisation normalisation_of(const Record& record, RowRange rows);

/// The rows `rows` of the channels that take part, normalised.
Record normalised(const Record& record, RowRange rows, const Normalisation& normalisation);

/// A model of normalised channels back in the units of the record. `y_offset` is the model's
/// operating point in normalised outputs. Channels left out get zero columns and zero rows.
StateSpaceModel in_units(const StateSpaceModel& model, const Normalisation& normalisation);

}  // namespace reident::identification
