// The formula behind the values of a parameter, where there is one. Private to storage.
//
// Telemetry counts steps: a converter gives an integer, a calibration turns it into a value, and
// decimal text rounds it. What is looked for is the formula that gives the values back to the last
// bit; a formula that is merely close is no formula.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace reident::storage {

/// Doubles in ascending order of their bits as integers: -NaN, -inf, ..., -0, 0, ..., inf, NaN.
/// Every bit pattern has a place of its own, neighbours differ by 1.
inline std::int64_t order_of(double value) {
  const auto bits = std::bit_cast<std::int64_t>(value);
  return bits < 0 ? bits ^ std::numeric_limits<std::int64_t>::max() : bits;
}
inline double from_order(std::int64_t order) {
  return std::bit_cast<double>(order < 0 ? order ^ std::numeric_limits<std::int64_t>::max()
                                         : order);
}

/// value = number / 10^decimals, correctly rounded as decimal text is.
struct DecimalSteps {
  int decimals = 0;
  std::vector<std::int64_t> numbers;  // one for each value
};
inline constexpr int most_decimals = 15;
double power_of_ten(int decimals);
inline double decimal_value(std::int64_t number, double power) {
  return static_cast<double>(number) / power;
}

/// value = offset + step * number, each operation rounded by itself.
struct AffineSteps {
  double offset = 0;
  double step = 0;
  std::vector<std::int64_t> numbers;  // one for each value
};

inline double affine_value(std::int64_t number, double offset, double step) {
  return offset + step * static_cast<double>(number);
}

/// Whether a formula can give this value at all: finite, and not -0.
bool is_countable(double value);

/// `values` are countable, distinct and ascending.
std::optional<DecimalSteps> find_decimal_steps(std::span<const double> values);

/// Steps of which the values are multiples but for rounding: offset is values[0], and
/// affine_value() may miss a value by some units in the last place. Empty if there is no such step
/// well above the rounding.
std::optional<AffineSteps> find_near_steps(std::span<const double> values);

/// Exact steps; `near` is what find_near_steps() found for these values. The offset is 0, values[0]
/// or a number of at most three decimals, as the lower end of a converter's range is, not more than
/// 65536 steps away.
std::optional<AffineSteps> find_affine_steps(std::span<const double> values,
                                             const AffineSteps& near);

}  // namespace reident::storage
