// The compression of a record whose channels are taken as they are.
#pragma once

#include <cstdint>

#include "identification/subspace/hankel.hpp"
#include "tests/support/systems.hpp"

namespace reident::test {

/// Every channel takes part, neither centred nor scaled.
inline identification::Normalisation no_normalisation(const Record& record) {
  const Index m = record.u.cols(), p = record.y.cols();
  identification::Normalisation result{
      Vector::Zero(m), Vector::Ones(m), Vector::Zero(p), Vector::Ones(p), {}, {}};
  for (Index i = 0; i < m; ++i) result.inputs.push_back(i);
  for (Index q = 0; q < p; ++q) result.outputs.push_back(q);
  return result;
}

inline identification::HankelFactor compressed(const Record& record, Index horizon) {
  const identification::TickRange all{INT64_MIN, INT64_MAX};
  return compress(sums_of_rows(record, all, 2 * horizon), no_normalisation(record), record,
                  record.segments, horizon);
}

}  // namespace reident::test
