// Whether two results are the same to the last bit, which == does not show: it takes -0 for 0.
#pragma once

#include "identification/search/identify.hpp"
#include "identification/subspace/lag_sums.hpp"

namespace reident::test {

bool same_bits(const identification::RangeSums& a, const identification::RangeSums& b);

/// Models with all that is said of them, or the same verdict in the same words.
bool same_bits(const identification::IdentifyResult& a, const identification::IdentifyResult& b);

}  // namespace reident::test
