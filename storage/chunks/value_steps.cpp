#include "storage/chunks/value_steps.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace reident::storage {
namespace {

constexpr std::array<double, most_decimals + 1> powers_of_ten{
    1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
constexpr double exact_integers = 9007199254740992;  // 2^53
constexpr int offset_search = 65536;                 // steps, a converter of 16 bits

bool same_bits(double a, double b) {
  return order_of(a) == order_of(b);
}

/// What the rounding of two values can add to their difference.
double rounding_of(std::span<const double> values) {
  const double largest = std::max(std::abs(values.front()), std::abs(values.back()));
  return 2 * largest * std::numeric_limits<double>::epsilon();
}

bool numbers_with(std::span<const double> values, int decimals,
                  std::vector<std::int64_t>& numbers) {
  const double power = power_of_ten(decimals);
  numbers.clear();
  for (const double value : values) {
    const double scaled = value * power;
    if (!(std::abs(scaled) < exact_integers)) return false;
    const auto number = static_cast<std::int64_t>(std::nearbyint(scaled));
    if (!same_bits(decimal_value(number, power), value)) return false;
    numbers.push_back(number);
  }
  return true;
}

/// Euclid's algorithm on numbers that are multiples of the answer but for rounding.
double common_step(double a, double b, double tolerance) {
  while (b > tolerance) {
    const double rest = std::fmod(a, b);
    a = b;
    b = std::min(rest, b - rest);
  }
  return a;
}

bool fits(std::span<const double> values, AffineSteps& steps) {
  steps.numbers.clear();
  for (const double value : values) {
    const double number = std::nearbyint((value - steps.offset) / steps.step);
    if (!(std::abs(number) < exact_integers)) return false;
    steps.numbers.push_back(static_cast<std::int64_t>(number));
    if (!same_bits(affine_value(steps.numbers.back(), steps.offset, steps.step), value))
      return false;
  }
  return true;
}

/// The step for a given offset follows from the value farthest from it, but for its last bits.
bool fits_with_some_step(std::span<const double> values, double near_step, AffineSteps& steps) {
  const double farthest =
      std::abs(values.front() - steps.offset) > std::abs(values.back() - steps.offset)
          ? values.front()
          : values.back();
  const double number = std::nearbyint((farthest - steps.offset) / near_step);
  if (number == 0) return false;
  const double middle = (farthest - steps.offset) / number;
  for (const int ulps : {0, 1, -1, 2, -2, 3, -3, 4, -4}) {
    steps.step = from_order(order_of(middle) + ulps);
    if (fits(values, steps)) return true;
  }
  return false;
}

}  // namespace

double power_of_ten(int decimals) {
  return powers_of_ten[static_cast<std::size_t>(decimals)];
}

bool is_countable(double value) {
  return std::isfinite(value) && !same_bits(value, -0.0);
}

std::optional<DecimalSteps> find_decimal_steps(std::span<const double> values) {
  DecimalSteps steps;
  for (; steps.decimals <= most_decimals; ++steps.decimals)
    if (numbers_with(values, steps.decimals, steps.numbers)) return steps;
  return std::nullopt;
}

std::optional<AffineSteps> find_near_steps(std::span<const double> values) {
  if (values.size() < 3 || !std::isfinite(values.back() - values.front())) return std::nullopt;
  // A remainder is off by the rounding times the quotients before it.
  const double tolerance = 1024 * rounding_of(values);
  double step = values[1] - values[0];
  for (std::size_t i = 2; i < values.size() && step > 64 * tolerance; ++i)
    step = common_step(values[i] - values[i - 1], step, tolerance);
  if (!(step > 64 * tolerance)) return std::nullopt;

  // The step gets more exact with every value, so that each is counted with what is known so far.
  AffineSteps steps{.offset = values[0], .step = step, .numbers = {0}};
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double more = std::nearbyint((values[i] - values[i - 1]) / steps.step);
    steps.numbers.push_back(steps.numbers.back() + static_cast<std::int64_t>(more));
    steps.step = (values[i] - values[0]) / static_cast<double>(steps.numbers.back());
  }
  return steps;
}

std::optional<AffineSteps> find_affine_steps(std::span<const double> values,
                                             const AffineSteps& near) {
  AffineSteps steps;
  for (const double offset : {0.0, values[0]}) {
    steps.offset = offset;
    if (fits_with_some_step(values, near.step, steps)) return steps;
  }
  const double rounding = rounding_of(values);
  const double step_error = 4 * rounding / static_cast<double>(near.numbers.back());
  for (int distance = 0; distance <= offset_search; ++distance)
    for (const double away : {-near.step * distance, near.step * distance}) {
      const double end = values[0] + away;
      steps.offset = std::nearbyint(end * 1000) / 1000;
      if (!(std::abs(end - steps.offset) <= 2 * rounding + step_error * distance)) continue;
      if (fits_with_some_step(values, near.step, steps)) return steps;
    }
  return std::nullopt;
}

}  // namespace reident::storage
