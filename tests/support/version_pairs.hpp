// Pairs of models of one equipment, as an older and a newer version of it would be.
#pragma once

#include <cstdint>

#include "service/model/model_version.hpp"

namespace reident::test {

struct VersionPair {
  EquipmentModel before, after;
};

/// Orders 1 to 8, 1 to 4 inputs, 1 or 2 outputs. Of two pairs one has an `after` whose numbers
/// differ by some percent, the other one of another order, other poles and gains that differ by up
/// to 30 %.
VersionPair version_pair(std::uint64_t seed);

/// Slow sines and ramps within the pair's ranges at tick k.
identification::Vector smooth_input(const VersionPair& pair, std::uint64_t seed, std::int64_t k);

}  // namespace reident::test
