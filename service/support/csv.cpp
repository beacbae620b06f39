#include "service/support/csv.hpp"

#include <charconv>
#include <cmath>
#include <system_error>

#include "service/support/text.hpp"

namespace reident::csv {

std::optional<double> to_number(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') cell.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

}  // namespace reident::csv
