#include "service/judgement/gate.hpp"

#include <cmath>

namespace reident {

using Code = ReasonCode;

namespace {

/// The name of an output that keeps one value on the validation part; empty: none does.
std::string still_output(const PreparedWindow& prepared) {
  const identification::RowRange rows = prepared.candidate->parts.validate;
  for (identification::Index q = 0; q < prepared.data.record.y.cols(); ++q) {
    const auto y = prepared.data.record.y.col(q).segment(rows.begin, rows.size());
    if (y.maxCoeff() == y.minCoeff())
      return prepared.data.outputs[static_cast<std::size_t>(q)].name;
  }
  return {};
}

}  // namespace

Evidence evidence_of(const PreparedWindow& prepared, const RefreshRequest& request) {
  const Candidate& candidate = *prepared.candidate;
  const EquipmentModel& model = candidate.model;
  const Duration window =
      candidate.adapted_from ? request.equipment.window : request.window.end - request.window.begin;
  return {is_well_formed(model.dynamics),
          spectral_radius(model.dynamics),
          slowest_time_constant_s(model.dynamics) * 1e9 / static_cast<double>(window),
          model.validation.mrse(),
          model.validation.fit(),
          still_output(prepared)};
}

std::optional<Reason> inadmissible(const Evidence& e, const EquipmentConfig& limits) {
  const bool is_still = !e.still_output.empty();
  if (!e.well_formed || (!std::isfinite(e.mrse_percent) && !is_still))
    return because<Code::not_finite>();
  if (!(e.spectral_radius < 1.0)) return because<Code::unstable>(e.spectral_radius);
  // A time constant longer than the window is an integrator as far as the window can tell.
  if (e.slowest_over_window > 1) return because<Code::slower_than_window>(e.slowest_over_window);
  if (std::isfinite(e.mrse_percent) && e.mrse_percent > limits.max_mrse_percent)
    return because<Code::error_above_limit>(e.mrse_percent, limits.max_mrse_percent);
  if (is_still) return because<Code::still_validation>(e.still_output);
  if (!(e.fit_percent > 0)) return because<Code::not_better_than_mean>(e.fit_percent);
  return std::nullopt;
}

}  // namespace reident
