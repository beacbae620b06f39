// The gain of the feedback that makes a model follow the measured output. n, m and p are the order
// and the numbers of inputs and outputs of the model.
#pragma once

#include "identification/state_space.hpp"

namespace reident::identification {

struct TrackingGain {
  Matrix state;        // m x n
  Matrix integral;     // m x 2p
  Vector error_limit;  // p, output units
};

}  // namespace reident::identification
