#include "identification/samples/verdict.hpp"

#include <charconv>

namespace reident::identification {

std::string_view name(VerdictCode code) {
  switch (code) {
    case VerdictCode::too_few_samples:
      return "too_few_samples";
    case VerdictCode::non_finite:
      return "non_finite";
    case VerdictCode::constant_inputs:
      return "constant_inputs";
    case VerdictCode::constant_outputs:
      return "constant_outputs";
    case VerdictCode::insufficient_excitation:
      return "insufficient_excitation";
    case VerdictCode::unstable:
      return "unstable";
    case VerdictCode::no_better_than_mean:
      return "no_better_than_mean";
    case VerdictCode::closed_loop:
      return "closed_loop";
    case VerdictCode::no_continuous_time:
      return "no_continuous_time";
    case VerdictCode::no_gain:
      return "no_gain";
  }
  return "unknown";
}

std::string channel_name(std::string_view kind, std::ptrdiff_t channel,
                         const std::vector<std::string>& names) {
  if (static_cast<std::size_t>(channel) < names.size())
    return names[static_cast<std::size_t>(channel)];
  return std::string(kind) + " " + std::to_string(channel + 1);
}

namespace {

std::string digits(double value, int count) {
  char buffer[32];
  const auto end =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, count).ptr;
  return {buffer, end};
}

}  // namespace

std::string four_digits(double value) {
  return digits(value, 4);
}

std::string two_digits(double value) {
  return digits(value, 2);
}

}  // namespace reident::identification
