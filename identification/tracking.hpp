// Integral feedback of the real output: a model that follows live telemetry.
#pragma once

#include "identification/state_space.hpp"

namespace reident::identification {

/// Gains of the correction input. n, m and p are those of the model.
struct TrackingGain {
  Matrix state;        // m x n; of the state less that of the free run
  Matrix integral;     // m x 2p; of the two integrators of each output, chained
  Vector error_limit;  // p, output units; errors beyond it count as it
};

}  // namespace reident::identification
