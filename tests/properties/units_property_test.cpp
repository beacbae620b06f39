// What holds in every unit of the outputs: nothing depends on it.
#include <cmath>
#include <variant>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "identification/correction/integral_feedback_search.hpp"
#include "identification/correction/pole_placement_search.hpp"
#include "identification/fit/adaptation.hpp"
#include "identification/search/identify.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/initial_state.hpp"
#include "tests/properties/any_record.hpp"

namespace reident::identification::units_property_test {
namespace {

using reident::test::any_of;

constexpr double equal = 1e-6;  // relative

/// A system whose model has other gains, its record in segments, and other units of the outputs.
struct Case {
  test::Setting setting;
  StateSpaceModel model;
  Record record;
  Vector units;  // p, from 1e-6 to 1e6

  StateSpaceModel in_units(StateSpaceModel other) const { return scaled(std::move(other), units); }
  StateSpaceModel from_units(StateSpaceModel other) const {
    return scaled(std::move(other), units.cwiseInverse());
  }
  Record in_units(Record other) const {
    other.y = (other.y * units.asDiagonal()).eval();
    return other;
  }

 private:
  static StateSpaceModel scaled(StateSpaceModel model, const Vector& by) {
    model.C = (by.asDiagonal() * model.C).eval();
    model.D = (by.asDiagonal() * model.D).eval();
    model.y0 = by.cwiseProduct(model.y0).eval();
    if (model.K.size() > 0) model.K = (model.K * by.cwiseInverse().asDiagonal()).eval();
    return model;
  }
};

Case any_case(const test::SettingLimits& limits, Index rows) {
  test::Setting setting = test::any_setting(limits);
  Case found{setting, setting.truth, {}, {}};
  found.record = test::excited(setting.truth, setting.noise, rows, any_of(1, 31) / 100.0);
  test::cut(found.record, 4);
  found.model.B *= 1.1;
  found.units.resize(setting.truth.outputs());
  for (double& unit : found.units) unit = std::exp2(any_of(-20, 21));
  return found;
}

RC_GTEST_PROP(AnyUnits, TheInitialStateAndTheRunAreTheSame, ()) {
  const Case c = any_case({6, 3, 4}, 800);
  const StateSpaceModel model = c.in_units(c.model);
  const Record record = c.in_units(c.record);
  const Vector x0 = estimate_initial_state(c.model, c.record, c.record.segments, state_rows);
  const Vector in_units = estimate_initial_state(model, record, record.segments, state_rows);
  RC_ASSERT((in_units - x0).norm() <= equal * (1 + x0.norm()));
  const Matrix run = free_run(c.model, c.record, c.record.all()) * c.units.asDiagonal();
  const Matrix run_in_units = free_run(model, record, record.all());
  for (Index q = 0; q < run.cols(); ++q)
    RC_ASSERT((run_in_units.col(q) - run.col(q)).norm() <= equal * run.col(q).norm());
}

RC_GTEST_PROP(AnyUnits, AnAdaptedModelIsTheSame, ()) {
  Case c = any_case({6, 3, 4}, 800);
  if (any_of(0, 2) == 1) c.record.y.col(0).setConstant(3);
  const Record record = c.in_units(c.record);
  for (const KnownFrom from : {KnownFrom::these_rows, KnownFrom::other_rows}) {
    const StateSpaceModel found = adapted(c.model, c.record, c.record.all(), from);
    const StateSpaceModel in_units = adapted(c.in_units(c.model), record, record.all(), from);
    RC_ASSERT(test::markov_distance(c.from_units(in_units), found) <= equal);
  }
}

RC_GTEST_PROP(AnyUnits, AnIdentifiedModelIsTheSame, ()) {
  const Case c = any_case({4, 3, 3, 0.8}, 1500);
  const Record record = c.in_units(c.record);
  IdentifyOptions options;
  options.order = static_cast<int>(c.model.order());
  options.horizon = *options.order + 3;
  options.weighting = Weighting::cva;
  options.direct_feedthrough = true;
  options.response_fit = ResponseFit::simulation;
  const IdentifyResult found = identify(c.record, c.record.all(), options);
  const IdentifyResult in_units = identify(record, record.all(), options);
  RC_ASSERT(found.index() == in_units.index());
  RC_PRE(std::holds_alternative<Identified>(found));
  const StateSpaceModel model = c.from_units(std::get<Identified>(in_units).model);
  RC_ASSERT(test::markov_distance(model, std::get<Identified>(found).model) <= equal);
}

RC_GTEST_PROP(AnyUnits, ACorrectedModelAndOneThatFollowsErrTheSame, ()) {
  Case c = any_case({4, 3, 3, 0.8}, 600);
  c.model.A *= 0.9;  // so that a correction helps
  const RowRange identify{0, 300}, tune{300, 600};
  const StateSpaceModel model = c.in_units(c.model);
  const Record record = c.in_units(c.record);
  const auto corrected = search_correction(c.model, c.record, identify, tune, in_sequence).best;
  const auto in_units = search_correction(model, record, identify, tune, in_sequence).best;
  RC_ASSERT(corrected.has_value() == in_units.has_value());
  if (corrected) RC_ASSERT(std::abs(in_units->error.mrse() / corrected->error.mrse() - 1) <= equal);
  const auto follows = search_tracking(c.model, c.record, identify, tune);
  const auto follows_in_units = search_tracking(model, record, identify, tune);
  RC_ASSERT(follows.index() == follows_in_units.index());
  if (const auto* found = std::get_if<TrackingSearch>(&follows)) {
    const double error = std::get<TrackingSearch>(follows_in_units).tracking.mrse();
    RC_ASSERT(std::abs(error / found->tracking.mrse() - 1) <= equal);
  }
}

}  // namespace
}  // namespace reident::identification::units_property_test
