#include "service/support/rate_text.hpp"

#include <cmath>

#include "service/support/csv.hpp"

namespace reident {

std::optional<double> parse_rate(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash == text.npos) return std::nullopt;
  const std::string_view unit = text.substr(slash + 1);
  const double seconds = unit == "s" ? 1 : unit == "min" ? 60 : unit == "h" ? 3600 : 0;
  const std::optional<double> count = csv::to_number(text.substr(0, slash));
  if (seconds == 0 || !count || !(*count > 0) || !std::isfinite(*count)) return std::nullopt;
  return *count / seconds;
}

}  // namespace reident
