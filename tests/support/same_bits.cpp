#include "tests/support/same_bits.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

namespace reident::test {
namespace {

using namespace identification;

bool same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool same(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || same(*a, *b));
}

bool same(const Matrix& a, const Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::equal(a.data(), a.data() + a.size(), b.data(),
                    [](double x, double y) { return same(x, y); });
}

bool same(const SegmentSums& a, const SegmentSums& b) {
  return a.ticks() == b.ticks() && same(a.reference(), b.reference()) && same(a.sum(), b.sum()) &&
         same(a.least(), b.least()) && same(a.greatest(), b.greatest()) &&
         same(a.products(), b.products()) && same(a.first(), b.first()) && same(a.last(), b.last());
}

bool same(const StateSpaceModel& a, const StateSpaceModel& b) {
  return same(a.A, b.A) && same(a.B, b.B) && same(a.C, b.C) && same(a.D, b.D) && same(a.K, b.K) &&
         same(a.u0, b.u0) && same(a.y0, b.y0) && same(a.period_s, b.period_s);
}

bool same(const Recipe& a, const Recipe& b) {
  return a.order == b.order && a.horizon == b.horizon && a.weighting == b.weighting &&
         a.stability == b.stability && a.fit == b.fit && a.direct == b.direct &&
         a.operating_point == b.operating_point && a.refinement_steps == b.refinement_steps &&
         a.refined_rows == b.refined_rows && a.eliminated_from == b.eliminated_from &&
         a.drift_half_periods == b.drift_half_periods && a.weighted == b.weighted &&
         a.least_rate == b.least_rate;
}

bool same(const Identified& a, const Identified& b) {
  return same(a.model, b.model) && same(a.x0, b.x0) && same(a.recipe, b.recipe) &&
         same(a.spectral_radius, b.spectral_radius) && same(a.singular_values, b.singular_values) &&
         same(a.hankel_condition, b.hankel_condition) && same(a.input_min, b.input_min) &&
         same(a.input_max, b.input_max) && same(a.held_out_error, b.held_out_error) &&
         same(a.search_work, b.search_work) && a.input_delays == b.input_delays &&
         a.warnings == b.warnings;
}

}  // namespace

bool same_bits(const RangeSums& a, const RangeSums& b) {
  return std::equal(a.segments.begin(), a.segments.end(), b.segments.begin(), b.segments.end(),
                    [](const SegmentSums& x, const SegmentSums& y) { return same(x, y); });
}

bool same_bits(const IdentifyResult& a, const IdentifyResult& b) {
  if (a.index() != b.index()) return false;
  if (const auto* verdict = std::get_if<Verdict>(&a))
    return verdict->code == std::get<Verdict>(b).code &&
           verdict->reason == std::get<Verdict>(b).reason;
  return same(std::get<Identified>(a), std::get<Identified>(b));
}

}  // namespace reident::test
