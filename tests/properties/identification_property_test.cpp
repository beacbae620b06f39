// What holds for every system, record and pattern of gaps.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "identification/hankel.hpp"
#include "identification/identify.hpp"
#include "identification/response.hpp"
#include "identification/subspace.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification {
namespace {

struct Setting {
  StateSpaceModel truth;
  testing::Noise noise;
};

Setting any_setting(int max_order, int max_inputs, int max_outputs, double max_modulus = 0.9) {
  testing::Noise noise(*rc::gen::arbitrary<std::uint32_t>());
  const int n = *rc::gen::inRange(1, max_order + 1), m = *rc::gen::inRange(1, max_inputs + 1);
  const int p = *rc::gen::inRange(1, max_outputs + 1);
  return {testing::random_system(noise, n, m, p, max_modulus), noise};
}

/// Cuts the record into up to four segments, as if rows had been lost between them.
void cut(Record& record) {
  const auto cuts =
      *rc::gen::container<std::vector<int>>(static_cast<std::size_t>(*rc::gen::inRange(0, 4)),
                                            rc::gen::inRange(1, static_cast<int>(record.rows())));
  std::vector<Index> edges(cuts.begin(), cuts.end());
  edges.insert(edges.end(), {0, record.rows()});
  std::sort(edges.begin(), edges.end());
  record.segments.clear();
  std::int64_t tick = 0;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    if (edges[i] == edges[i + 1]) continue;
    record.segments.push_back({edges[i], edges[i + 1], tick});
    tick += edges[i + 1] - edges[i] + 7;
  }
}

RC_GTEST_PROP(Identification, PolesAndMarkovParametersConvergeWithoutNoise, ()) {
  Setting s = any_setting(8, 4, 3);
  Record record = testing::excited(s.truth, s.noise, 1500, 0);
  cut(record);
  const HankelFactor factor = compress(record, record.all(), 24);
  RC_PRE(factor.columns >= 2 * factor.R.rows());
  const Projection projection(factor, 12);
  const Dynamics dynamics = shift_invariant(projection.observability(Weighting::moesp).gamma,
                                            s.truth.outputs(), s.truth.order());
  const Response found =
      fit_response(dynamics.A, dynamics.C, record, record.all(), Accuracy::exact);
  // Nearly cancelling or double poles are ill-conditioned: what the model does is not.
  RC_ASSERT(testing::markov_distance(found.model, s.truth) < 1e-4);
}

RC_GTEST_PROP(Identification, NoiseMovesTheModelByAsMuchAsItIsLarge, ()) {
  Setting s = any_setting(4, 3, 2, 0.8);
  const double share = *rc::gen::inRange(0, 31) / 100.0;
  const Record record = testing::excited(s.truth, s.noise, 4000, share);
  IdentifyOptions options;
  options.order = static_cast<int>(s.truth.order());
  options.horizon = 10;
  const IdentifyResult result = identify(record, record.all(), options);
  RC_ASSERT(std::holds_alternative<Identified>(result));
  RC_ASSERT(testing::markov_distance(std::get<Identified>(result).model, s.truth) < 0.01 + share);
}

RC_GTEST_PROP(Compression, SumsAndRowsGiveTheSameInnerProducts, ()) {
  Setting s = any_setting(4, 3, 2);
  Record record = testing::excited(s.truth, s.noise, 300, 0.2);
  cut(record);
  const Index L = *rc::gen::inRange(2, 8);
  RC_PRE(hankel_columns(record.segments, L) > 1 + L * (record.u.cols() + record.y.cols()));
  const HankelFactor whole = compress(record, record.all(), L);
  Matrix sum = Matrix::Zero(whole.R.rows(), whole.R.cols());
  Index columns = 0;
  for (const Segment& segment : record.segments) {
    const HankelFactor part = compress(record, {segment.begin, segment.end}, L);
    sum += part.R.transpose() * part.R;
    columns += part.columns;
  }
  RC_ASSERT(columns == whole.columns);
  RC_ASSERT((whole.R.transpose() * whole.R - sum).norm() < 1e-9 * sum.norm());
}

RC_GTEST_PROP(Identification, AnyNumbersGiveAStableModelOrAVerdict, ()) {
  const int rows = *rc::gen::inRange(0, 160), m = *rc::gen::inRange(0, 4);
  const int p = *rc::gen::inRange(1, 3);
  testing::Noise noise(*rc::gen::arbitrary<std::uint32_t>());
  Record record = contiguous_record(1, noise.normal(rows, m), noise.normal(rows, p));
  const double step = *rc::gen::element(0.0, 0.1, 1.0, 3.0);  // of quantisation
  if (step > 0) {
    record.u = (record.u / step).array().round() * step;
    record.y = (record.y / step).array().round() * step;
  }
  if (m > 1 && *rc::gen::arbitrary<bool>()) record.u.col(1) = 2 * record.u.col(0);
  if (rows > 10) cut(record);
  const IdentifyResult result = identify(record, record.all(), {});
  if (const auto* found = std::get_if<Identified>(&result)) {
    RC_ASSERT(is_well_formed(found->model));
    RC_ASSERT(found->spectral_radius < 1);
  } else {
    RC_ASSERT(!std::get<Verdict>(result).reason.empty());
  }
}

}  // namespace
}  // namespace reident::identification
