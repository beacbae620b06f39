// Why a stretch of telemetry gives no model: a code for programs and a sentence for an operator.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace reident::identification {

enum class VerdictCode {
  too_few_samples,
  non_finite,
  constant_inputs,
  constant_outputs,
  insufficient_excitation,
  unstable,
  no_better_than_mean,
  no_continuous_time,
  no_gain,
};

/// The code as it is stored and printed, such as "too_few_samples".
std::string_view name(VerdictCode code);

struct Verdict {
  VerdictCode code;
  std::string reason;  // one sentence: what, where, and what would mend it
};

/// The channel's name, or "input 3" for the channel 2 where it has none: people count from one.
std::string channel_name(std::string_view kind, std::ptrdiff_t channel,
                         const std::vector<std::string>& names);

/// A number to four digits, as sentences hold it.
std::string four_digits(double value);

}  // namespace reident::identification
