#include "service/judgement/gate.hpp"

#include <cmath>

namespace reident {

using Code = ReasonCode;

Evidence evidence_of(const PreparedWindow& prepared, const RefreshRequest& request) {
  const Candidate& candidate = *prepared.candidate;
  const EquipmentModel& model = candidate.model;
  const Duration window =
      candidate.adapted_from ? request.equipment.window : request.window.end - request.window.begin;
  return {is_well_formed(model.dynamics), spectral_radius(model.dynamics),
          slowest_time_constant_s(model.dynamics) * 1e9 / static_cast<double>(window),
          model.validation.mrse(), model.validation.fit()};
}

std::optional<Reason> inadmissible(const Evidence& e, const EquipmentConfig& limits) {
  if (!e.well_formed || !std::isfinite(e.mrse_percent)) return because<Code::not_finite>();
  if (!(e.spectral_radius < 1.0)) return because<Code::unstable>(e.spectral_radius);
  // A time constant longer than the window is an integrator as far as the window can tell.
  if (e.slowest_over_window > 1) return because<Code::slower_than_window>(e.slowest_over_window);
  if (e.mrse_percent > limits.max_mrse_percent)
    return because<Code::error_above_limit>(e.mrse_percent, limits.max_mrse_percent);
  if (!(e.fit_percent > 0)) return because<Code::not_better_than_mean>(e.fit_percent);
  return std::nullopt;
}

}  // namespace reident
