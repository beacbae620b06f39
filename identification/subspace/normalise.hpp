// Centre and scale of the channels: the work is done on signals of mean 0 and deviation 1, so that
// neither units nor a large operating point decide how exact sums and factors are (METHOD.md,
// section 3). m inputs and p outputs are those of the record. Nothing here throws.
#pragma once

#include <vector>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"
#include "identification/subspace/lag_sums.hpp"

namespace reident::identification {

/// Means and deviations in the channels' units. A channel that is left out has the scale 1.
struct Normalisation {
  Vector u_mean, u_scale;      // m
  Vector y_mean, y_scale;      // p
  std::vector<Index> inputs;   // channels that take part, ascending
  std::vector<Index> outputs;  // channels that take part, ascending
};

/// Returns the normalisation of the channels, the first `inputs` of which are inputs. A channel
/// takes part where its deviation is above 1e-13 of its mean. Requires at least one row.
Normalisation normalisation_of(const RangeSums& sums, Index inputs);

/// Returns the correlations of the inputs that take part. Requires at least one row.
Matrix input_correlation(const RangeSums& sums, const Normalisation& normalisation);

/// Returns the rows `rows` of the channels that take part, normalised.
Record normalised(const Record& record, RowRange rows, const Normalisation& normalisation);

/// Gives a model of normalised channels the operating point `mean`, [u; y] in units (m + p).
void set_operating_point(StateSpaceModel& model, const Normalisation& normalisation,
                         const Vector& mean);

/// Returns a model of normalised channels in the units of the record (m inputs, p outputs).
/// Channels left out get zero columns and zero rows.
StateSpaceModel in_units(const StateSpaceModel& model, const Normalisation& normalisation);

}  // namespace reident::identification
