#include "service/judgement/gate.hpp"

#include <cmath>

namespace reident {

using Code = ReasonCode;

std::optional<Reason> inadmissible(double mrse_percent, double fit_percent,
                                   const EquipmentConfig& limits) {
  if (!std::isfinite(mrse_percent)) return because<Code::not_finite>();
  if (mrse_percent > limits.max_mrse_percent)
    return because<Code::error_above_limit>(mrse_percent, limits.max_mrse_percent);
  if (!(fit_percent > 0)) return because<Code::not_better_than_mean>(fit_percent);
  return std::nullopt;
}

std::optional<Reason> inadmissible(const Evidence& e, const EquipmentConfig& limits) {
  if (!e.well_formed) return because<Code::not_finite>();
  if (!(e.spectral_radius < 1.0)) return because<Code::unstable>(e.spectral_radius);
  // A time constant longer than the window is an integrator as far as the window can tell.
  if (e.slowest_over_window > 1) return because<Code::slower_than_window>(e.slowest_over_window);
  const auto reason = inadmissible(e.mrse_percent, e.fit_percent, limits);
  const bool is_above = reason && reason->code == Code::error_above_limit;
  if (!e.still_output.empty() && !is_above) return because<Code::still_validation>(e.still_output);
  return reason;
}

}  // namespace reident
