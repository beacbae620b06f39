// Whether a candidate may become a challenger (R4): what its window alone says against it.
//
// The telemetry of its validation part and after its window decides on a challenger (league.hpp).
#pragma once

#include <optional>
#include <string>

#include "service/config/config.hpp"
#include "service/model/reasons.hpp"

namespace reident {

/// What is looked at of a candidate. Scores are of its free run on the validation part.
struct Evidence {
  bool well_formed = false;  // sizes agree, all numbers finite
  double spectral_radius = 0;
  double slowest_over_window = 0;  // the longest time constant over the window's length
  double mrse_percent = 0;
  double fit_percent = 0;    // the worst output's
  std::string still_output;  // one that keeps its value on the validation part; empty: none
};

/// Returns what speaks against it; absent where it is admissible.
std::optional<Reason> inadmissible(const Evidence& evidence, const EquipmentConfig& limits);
/// Likewise of errors alone, of a window or of a record.
std::optional<Reason> inadmissible(double mrse_percent, double fit_percent,
                                   const EquipmentConfig& limits);

}  // namespace reident
