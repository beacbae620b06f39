#include "service/judgement/gate.hpp"

#include <cmath>

namespace reident {
namespace {

using identification::Matrix;
using Code = ReasonCode;

/// A time constant of more windows than this is an integrator as far as the window can tell: what
/// little drives it adds up.
constexpr double slowest_limit = 1.0;

bool every_column_moves(const Matrix& samples) {
  return (samples.colwise().maxCoeff().array() > samples.colwise().minCoeff().array()).all();
}

}  // namespace

Evidence evidence_of(const PreparedWindow& prepared, const RefreshRequest& request) {
  const Candidate& candidate = *prepared.candidate;
  const EquipmentModel& model = candidate.model;
  const Duration window =
      candidate.adapted_from ? request.equipment.window : request.window.end - request.window.begin;
  const identification::RowRange rows = candidate.parts.validate;
  Evidence evidence;
  evidence.well_formed = is_well_formed(model.dynamics);
  evidence.spectral_radius = spectral_radius(model.dynamics);
  evidence.slowest_over_window =
      slowest_time_constant_s(model.dynamics) * 1e9 / static_cast<double>(window);
  evidence.validation_moves =
      every_column_moves(prepared.data.record.y.middleRows(rows.begin, rows.size()));
  evidence.mrse_percent = model.validation.mrse();
  evidence.fit_percent = model.validation.fit();
  return evidence;
}

std::optional<Reason> inadmissible(const Evidence& e, const EquipmentConfig& limits) {
  if (!e.validation_moves) return because<Code::validation_says_nothing>();
  if (!e.well_formed || !std::isfinite(e.mrse_percent) || std::isnan(e.fit_percent))
    return because<Code::not_finite>();
  if (!(e.spectral_radius < 1.0)) return because<Code::unstable>(e.spectral_radius);
  if (e.slowest_over_window > slowest_limit)
    return because<Code::slower_than_window>(e.slowest_over_window);
  if (e.mrse_percent > limits.max_mrse_percent)
    return because<Code::error_above_limit>(e.mrse_percent, limits.max_mrse_percent);
  if (!(e.fit_percent > 0) || e.fit_percent < limits.min_fit_percent)
    return because<Code::fit_below_limit>(e.fit_percent, limits.min_fit_percent);
  return std::nullopt;
}

}  // namespace reident
