// Recent samples over older ones: what a series holds is its chunks, and what came since.
#pragma once

#include <vector>

#include "storage/types/sample_columns.hpp"

namespace reident::storage {

/// Lays `newer` over `base`, the later of `newer` over the earlier: of several samples at one time
/// the one laid on last stays. All have the same wanted columns.
void overlay(SampleColumns& base, const std::vector<const SampleColumns*>& newer);

}  // namespace reident::storage
