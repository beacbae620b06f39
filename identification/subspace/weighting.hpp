// The weightings of the oblique projection. Nothing here throws.
#pragma once

#include <string_view>

namespace reident::identification {

/// W1 and W2 of W1 O W2 (METHOD.md, section 5): each gives another estimate of the same subspace,
/// and which is best depends on the noise.
enum class Weighting { n4sid, moesp, cva };

/// Returns "n4sid", "moesp" or "cva".
std::string_view name(Weighting weighting);

}  // namespace reident::identification
