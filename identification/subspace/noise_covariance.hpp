// The noise that a model leaves of the compressed data (METHOD.md, section 8).
#pragma once

#include "identification/simulation/state_space.hpp"
#include "identification/subspace/projection.hpp"

namespace reident::identification {

/// Returns the covariance [Q S; S' R] (n + p square) of the process and measurement noises, the
/// residuals of the state equations of two consecutive steps. Requires a well-formed model of the
/// projection's channels, in its units. Nothing throws.
Matrix noise_covariance(const Projection& projection, const StateSpaceModel& model);

}  // namespace reident::identification
