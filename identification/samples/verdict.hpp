// Why a range of telemetry gives no result: a code for programs and a sentence for an operator.
// Expected failures are values: whatever telemetry holds, a function returns a verdict and throws
// nothing. Wrong arguments, such as sizes that disagree, are mistakes of the program (assert).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace reident::identification {

/// What was wrong; METHOD.md has the limits in the sections named.
enum class VerdictCode {
  /// Fewer rows without a gap than the smallest horizon needs (7).
  too_few_samples,
  /// A value is not finite or exceeds 1e150 (1).
  non_finite,
  /// No input, or no output, moves (3).
  constant_inputs,
  constant_outputs,
  /// The inputs do not determine the smallest order asked for (5).
  insufficient_excitation,
  /// No model asked for is stable (7).
  unstable,
  /// The inputs do not explain the outputs (7).
  no_better_than_mean,
  /// Inputs follow outputs, and the model would be the controller's or unstable (20).
  closed_loop,
  /// No differential equation has these samples (10).
  no_continuous_time,
  /// Poles cannot be placed as asked for, or no placement lowers the error (12, 14).
  no_gain,
};

/// Returns the code as it is stored and printed, such as "too_few_samples".
std::string_view name(VerdictCode code);

/// Takes the place of a result.
struct Verdict {
  VerdictCode code;
  std::string reason;  // one sentence: what, where, and what would mend it
};

/// Returns the name of a channel (counted from 0) of the `kind` "input" or "output". Where it has
/// none, that is "input 3" for the channel 2: people count from one.
std::string channel_name(std::string_view kind, std::ptrdiff_t channel,
                         const std::vector<std::string>& names);

/// Returns a number to four digits, as sentences hold it: "0.125" or "1e+20".
std::string four_digits(double value);
/// Returns a number to two digits, as what another one is uncertain by.
std::string two_digits(double value);

}  // namespace reident::identification
