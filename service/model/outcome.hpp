// What an attempt at a window comes to.
#pragma once

#include <string_view>

namespace reident {

/// What speaks against an attempt, or for it. A window that gives no model has the code of the
/// identification's verdict (identification/samples/verdict.hpp) as its outcome instead.
enum class Outcome {
  approved,
  waiting,            // good enough; the policy leaves the decision to an operator
  unvouched,          // better by a constant offset, which may be a sensor's; waits for an operator
  held,               // good enough; an operator holds the equipment's version
  on_probation,       // better, and nothing hurries; telemetry after the window decides
  unknown_parameter,  // telemetry has not described a parameter of the equipment yet
  telemetry_damaged,  // samples that the attempt needs cannot be decoded any more
  low_coverage,
  implausible,  // sensors contradict each other, or themselves, on too much of the window
  validation_says_nothing,
  not_finite,
  unstable,
  slower_than_window,  // a time constant that the window cannot tell
  error_above_limit,
  fit_below_limit,
  residual_out_of_range,
  inputs_out_of_range,
  not_better_than_baseline,
  older_than_champion,
  telemetry_in_doubt,  // so many sensor faults that more go unnoticed; the champion stays
  comparison_says_nothing,
  not_better_than_champion,
  disagrees_with_champion,
  too_soon,
};
std::string_view name(Outcome outcome);

}  // namespace reident
