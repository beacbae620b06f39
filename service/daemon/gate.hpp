// The gate: from the evidence about a candidate to the decision, as one pure function.
//
// service/DESIGN.md has the table of reasons.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "service/daemon/config.hpp"
#include "storage/telemetry.hpp"

namespace reident {

/// What speaks against an attempt, or for it. A window that gives no model has the code of the
/// identification's verdict (identification/verdict.hpp) as its outcome instead.
enum class Outcome {
  approved,
  waiting,            // good enough; the policy leaves the decision to an operator
  unknown_parameter,  // telemetry has not described a parameter of the equipment yet
  low_coverage,
  validation_says_nothing,
  not_finite,
  unstable,
  error_above_limit,
  fit_below_limit,
  residual_out_of_range,
  not_better_than_baseline,
  not_better_than_champion,
  older_than_champion,
};
std::string_view name(Outcome outcome);

/// Scores are free runs on the validation part, which the identification did not use.
struct Evidence {
  bool well_formed = false;  // sizes agree, all numbers finite
  double spectral_radius = 0;
  bool validation_moves = false;  // every output takes more than one value there
  double mrse_percent = 0;
  double fit_percent = 0;         // the worst output's
  double residual_over_span = 0;  // largest |error| of any output over its range in the window
  storage::Time window_end = 0;

  struct Champion {
    std::int64_t version = 0;
    double mrse_percent = 0;  // on the same samples; NaN or infinite where its run went astray
    storage::Time window_end = 0;
  };
  std::optional<Champion> champion;
};

struct GateDecision {
  Outcome outcome;
  std::string reason;  // one sentence with the figures that decided
};

GateDecision decide(const Evidence& evidence, const EquipmentConfig& limits);

}  // namespace reident
