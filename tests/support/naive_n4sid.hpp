// A slow, explicit N4SID that only tests link: it builds the block-Hankel matrices in full and
// follows the definitions (projections by pseudo-inverses), with no factor shared between steps.
#pragma once

#include "identification/samples/record.hpp"
#include "identification/search/identify.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::test {

/// A, C, B, D, y0 and x0 of the given order. The record's channels are used as they are.
struct NaiveResult {
  identification::StateSpaceModel model;
  identification::Vector x0;
  identification::Vector singular_values;
};
NaiveResult naive_n4sid(const identification::Record& record, identification::Index order,
                        identification::Index horizon, identification::Weighting weighting);

}  // namespace reident::test
