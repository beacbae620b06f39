// Operating regimes of an equipment, by the ranges of its inputs.
#pragma once

#include <vector>

#include "storage/types/registry_rows.hpp"

namespace reident {

/// Number of the operating regime of each block that counts, -1 for others: cycles over which the
/// inputs have about the same ranges are of one regime. A block is of the nearest regime that is
/// near enough, or begins one.
std::vector<int> regimes_of(const std::vector<storage::Block>& blocks);

}  // namespace reident
