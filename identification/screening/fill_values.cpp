#include "identification/screening/fill_values.hpp"

#include <algorithm>
#include <cmath>

namespace reident::identification {
namespace {

// Times the greatest magnitude of the others: where they have another sign, and for any value. An
// equipment that switches on may well draw a hundred times the noise of its current before.
constexpr double far = 10, absurd = 1e4;
constexpr Index least_fills = 2;

bool is_of_nines(double magnitude) {
  for (double nines = 99; nines < 1e16; nines = 10 * nines + 9)
    for (const double fraction : {1.0, 10.0, 100.0, 1000.0})
      if (magnitude == nines / fraction && magnitude >= 99) return true;
  return false;
}

bool is_end_of_integers(double value) {
  for (const double bits : {8.0, 16.0, 32.0}) {
    const double all = std::exp2(bits), half = all / 2;
    if (value == all - 1 || value == half - 1 || value == -half) return true;
  }
  return false;
}

/// Sorted values [begin, end): the others, and whether `value` may stand for none beside them.
bool stands_for_none(double value, const std::vector<double>& sorted, std::size_t begin,
                     std::size_t end) {
  const double low = sorted[begin], high = sorted[end - 1];
  const double greatest = std::max(std::abs(low), std::abs(high));
  const double gap = value < low ? low - value : value - high;
  const bool other_sign = value < 0 ? low >= 0 : high <= 0;
  if (greatest > 0 && std::abs(value) >= (other_sign ? far : absurd) * greatest) return true;
  return gap > high - low && gap > 0 && high > low &&
         (is_of_nines(std::abs(value)) || is_end_of_integers(value));
}

}  // namespace

std::vector<double> fill_values(const Vector& values) {
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  std::vector<double> found;
  std::size_t begin = 0, end = sorted.size();
  while (begin < end) {
    const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(end);
    const auto above =
        static_cast<std::size_t>(std::upper_bound(first, last, sorted[begin]) - sorted.begin());
    const auto below =
        static_cast<std::size_t>(std::lower_bound(first, last, sorted[end - 1]) - sorted.begin());
    if (above < end && above - begin >= static_cast<std::size_t>(least_fills) &&
        stands_for_none(sorted[begin], sorted, above, end)) {
      found.push_back(sorted[begin]);
      begin = above;
    } else if (below > begin && end - below >= static_cast<std::size_t>(least_fills) &&
               stands_for_none(sorted[end - 1], sorted, begin, below)) {
      found.push_back(sorted[end - 1]);
      end = below;
    } else {
      break;
    }
  }
  return found;
}

}  // namespace reident::identification
