// What holds for every system, record and pattern of gaps.
#include <algorithm>
#include <limits>

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "identification/fit/output_error_fit.hpp"
#include "identification/search/identify.hpp"
#include "identification/subspace/hankel.hpp"
#include "identification/subspace/input_response.hpp"
#include "identification/subspace/projection.hpp"
#include "identification/subspace/shift_invariance.hpp"
#include "identification/subspace/weighting.hpp"
#include "tests/properties/any_record.hpp"

namespace reident::identification::identification_property_test {
namespace {

/// The compression of a record as identify() makes it.
struct Compressed {
  Normalisation normalisation;
  Record work;
  HankelFactor factor;
};

Compressed compressed(const Record& record, Index horizon) {
  const TickRange all{std::numeric_limits<std::int64_t>::min(),
                      std::numeric_limits<std::int64_t>::max()};
  const RangeSums sums = sums_of_rows(record, all, 2 * horizon);
  const Normalisation normalisation = normalisation_of(sums, record.u.cols());
  const Record work = normalised(record, record.all(), normalisation);
  return {normalisation, work, compress(sums, normalisation, work, work.segments, horizon)};
}

Weighting any_weighting() {
  return *rc::gen::element(Weighting::n4sid, Weighting::moesp, Weighting::cva);
}

/// Smallest distance between two poles of the model; 1 for fewer.
double pole_separation(const StateSpaceModel& model) {
  const Eigen::VectorXcd poles = model.A.eigenvalues();
  double least = 1;
  for (Index i = 0; i < poles.size(); ++i)
    for (Index j = 0; j < i; ++j) least = std::min(least, std::abs(poles(i) - poles(j)));
  return least;
}

IdentifyOptions fixed_choice(Index order, Weighting weighting) {
  IdentifyOptions options;
  options.order = static_cast<int>(order);
  options.horizon = static_cast<int>(order) + 3;
  options.weighting = weighting;
  options.direct_feedthrough = true;
  options.response_fit = ResponseFit::simulation;
  return options;
}

RC_GTEST_PROP(Identification, WithoutNoisePolesAndMarkovParametersAreExact, ()) {
  test::Setting s = test::any_setting({});
  const Index n = s.truth.order(), p = s.truth.outputs();
  const Index horizon = n + test::any_of<Index>(1, 5);
  const Index size = 1 + 2 * horizon * (s.truth.inputs() + p);
  Record record = test::excited(s.truth, s.noise, 3 * size + 200, 0);
  test::cut(record, 4);
  RC_PRE(hankel_columns(record.segments, 2 * horizon) > size);
  const Compressed c = compressed(record, horizon);
  const Projection projection(c.factor);
  const Weighting weighting = *rc::gen::element(Weighting::n4sid, Weighting::moesp);
  const Dynamics found = shift_invariant(projection.observability(weighting).gamma, p, n);
  const StateSpaceModel by_sums =
      in_units(with_response(projection, found.A, found.C, true, 1), c.normalisation);
  const StateSpaceModel by_simulation =
      in_units(fit_response(found.A, found.C, true, c.work, c.work.all(), Accuracy::exact).model,
               c.normalisation);
  RC_ASSERT(test::markov_distance(by_sums, s.truth) < 1e-6);
  RC_ASSERT(test::markov_distance(by_simulation, s.truth) < 1e-6);
  // Nearly double poles are ill-conditioned: what the model does is not.
  if (pole_separation(s.truth) > 0.1) RC_ASSERT(test::pole_distance(by_sums, s.truth) < 1e-5);
}

RC_GTEST_PROP(Identification, WithNoiseTheErrorFallsAsRowsGrow, ()) {
  test::Setting s = test::any_setting({6, 4, 3, 0.8});
  const double share = test::any_of(1, 31) / 100.0;
  const IdentifyOptions options = fixed_choice(s.truth.order(), any_weighting());
  const auto error = [&](Index rows) {
    Record record = test::excited(s.truth, s.noise, rows, share);
    test::cut(record, 4);
    const IdentifyResult result = identify(record, record.all(), options);
    RC_ASSERT(std::holds_alternative<Identified>(result));
    return test::markov_distance(std::get<Identified>(result).model, s.truth);
  };
  const double coarse = error(1000), fine = error(16000);
  RC_ASSERT(fine < 0.02 + share / 10);
  RC_ASSERT(fine < std::max(coarse, 1e-3));
}

RC_GTEST_PROP(Identification, TheOrderOfTheSegmentsChangesNothingBeyondRounding, ()) {
  test::Setting s = test::any_setting({5, 4, 3});
  Record record = test::excited(s.truth, s.noise, 1200, test::any_of(1, 31) / 100.0);
  test::cut(record, 5);
  const Record other = test::with_segments_reversed(record);
  const IdentifyOptions options = fixed_choice(s.truth.order(), any_weighting());
  const IdentifyResult a = identify(record, record.all(), options);
  const IdentifyResult b = identify(other, other.all(), options);
  RC_ASSERT(a.index() == b.index());
  RC_PRE(std::holds_alternative<Identified>(a));
  RC_ASSERT(test::markov_distance(std::get<Identified>(b).model, std::get<Identified>(a).model) <
            1e-9);
}

RC_GTEST_PROP(Subspace, TheResponseOfTheTruthIsRecoveredFromTheCompression, ()) {
  test::Setting s = test::any_setting({});
  const bool direct = *rc::gen::arbitrary<bool>();
  if (!direct) s.truth.D.setZero();
  const Index n = s.truth.order(), horizon = n + test::any_of<Index>(1, 13);
  const Index size = 1 + 2 * horizon * (s.truth.inputs() + s.truth.outputs());
  Record record = test::excited(s.truth, s.noise, 3 * size + 200, 0);
  test::cut(record, 4);
  RC_PRE(hankel_columns(record.segments, 2 * horizon) > size);
  const Compressed c = compressed(record, horizon);
  const Matrix C = c.normalisation.y_scale.cwiseInverse().asDiagonal() * s.truth.C;
  const StateSpaceModel found =
      in_units(with_response(Projection(c.factor), s.truth.A, C, direct, 1), c.normalisation);
  // Neighbouring poles share B among them as rounding has it; what they do together is exact to
  // what normal equations of pivots above 1e-5 leave.
  RC_ASSERT(test::markov_distance(found, s.truth) < 1e-6);
  RC_ASSERT((found.D - s.truth.D).norm() < 1e-6);
}

RC_GTEST_PROP(Identification, AnyNumbersGiveAStableModelOrAVerdict, ()) {
  const int rows = test::any_of(0, 160), m = test::any_of(0, 4);
  const int p = test::any_of(1, 3);
  test::Noise noise(*rc::gen::arbitrary<std::uint32_t>());
  Record record = contiguous_record(1, noise.normal(rows, m), noise.normal(rows, p));
  const double step = *rc::gen::element(0.0, 0.1, 1.0, 3.0);  // of quantisation
  if (step > 0) {
    record.u = (record.u / step).array().round() * step;
    record.y = (record.y / step).array().round() * step;
  }
  if (m > 1 && *rc::gen::arbitrary<bool>()) record.u.col(1) = 2 * record.u.col(0);
  if (rows > 10) test::cut(record, 4);
  const IdentifyResult result = identify(record, record.all(), {});
  if (const auto* found = std::get_if<Identified>(&result)) {
    RC_ASSERT(is_well_formed(found->model));
    RC_ASSERT(found->spectral_radius < 1);
  } else {
    RC_ASSERT(!std::get<Verdict>(result).reason.empty());
  }
}

}  // namespace
}  // namespace reident::identification::identification_property_test
