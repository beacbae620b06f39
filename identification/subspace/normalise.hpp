// Centre and scale of the channels: the work is done on signals of mean 0 and deviation 1, so that
// neither units nor a large operating point decide how exact the sums and factors are.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"
#include "identification/subspace/lag_sums.hpp"

namespace reident::identification {

struct Normalisation {
  Vector u_mean, u_scale;      // m; scale 1 for a channel left out
  Vector y_mean, y_scale;      // p; scale 1 for a channel left out
  std::vector<Index> inputs;   // channels that take part, ascending
  std::vector<Index> outputs;  // channels that take part, ascending
};

/// Mean and standard deviation of the channels, the first `inputs` of which are inputs. A channel
/// takes part when it moves by more than the rounding of its own size.
Normalisation normalisation_of(const StretchSums& sums, Index inputs);

/// Correlations of the inputs that take part.
Matrix input_correlation(const StretchSums& sums, const Normalisation& normalisation);

/// The rows `rows` of the channels that take part, normalised.
Record normalised(const Record& record, RowRange rows, const Normalisation& normalisation);

/// Gives a model of normalised channels the operating point `mean` of all channels, [u; y] in
/// units.
void set_operating_point(StateSpaceModel& model, const Normalisation& normalisation,
                         const Vector& mean);

/// A model of normalised channels back in the units of the record. Channels left out get zero
/// columns and zero rows.
StateSpaceModel in_units(const StateSpaceModel& model, const Normalisation& normalisation);

}  // namespace reident::identification
