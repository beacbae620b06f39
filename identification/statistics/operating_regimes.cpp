#include "identification/statistics/operating_regimes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reident::identification {
namespace {

/// Cycles are of one regime where no end of an input's range is further away than this share of the
/// whole range.
constexpr double regime_width = 0.25;

}  // namespace

bool InputRanges::widen(const InputRanges& other) {
  if (low.empty()) {
    *this = other;
    return !low.empty();
  }
  bool has_grown = false;
  for (std::size_t i = 0; i < other.low.size(); ++i) {
    has_grown = has_grown || other.low[i] < low[i] || other.high[i] > high[i];
    low[i] = std::min(low[i], other.low[i]);
    high[i] = std::max(high[i], other.high[i]);
  }
  return has_grown;
}

InputRanges InputRanges::of(const std::vector<std::size_t>& places) const {
  InputRanges result;
  if (low.empty()) return result;
  for (const std::size_t place : places) {
    result.low.push_back(low.at(place));
    result.high.push_back(high.at(place));
  }
  return result;
}

bool OperatingRegimes::add(InputRanges block) {
  blocks_.push_back(std::move(block));
  InputRanges cycle;
  for (std::size_t i = blocks_.size(); i-- > 0 && blocks_.size() - i <= cycle_;)
    cycle.widen(blocks_[i]);
  cycles_.push_back(cycle);
  if (blocks_.size() <= cycle_) std::ranges::fill(cycles_, cycle);
  const bool are_others = all_.widen(blocks_.back());
  if (are_others) {
    first_.clear();
    numbers_.clear();
  }
  for (std::size_t i = numbers_.size(); i < cycles_.size(); ++i)
    numbers_.push_back(blocks_[i].low.empty() ? -1 : number_of(cycles_[i]));
  return are_others;
}

int OperatingRegimes::number_of(const InputRanges& cycle) {
  int number = -1;
  double nearest = regime_width;
  for (std::size_t r = 0; r < first_.size(); ++r)
    if (const double apart = distance(cycle, first_[r]); apart < nearest)
      nearest = apart, number = static_cast<int>(r);
  if (number >= 0) return number;
  first_.push_back(cycle);
  return static_cast<int>(first_.size()) - 1;
}

double OperatingRegimes::distance(const InputRanges& one, const InputRanges& other) const {
  double largest = 0;
  for (std::size_t i = 0; i < all_.low.size(); ++i)
    if (const double range = all_.high[i] - all_.low[i]; range > 0)
      largest = std::max({largest, std::abs(one.low[i] - other.low[i]) / range,
                          std::abs(one.high[i] - other.high[i]) / range});
  return largest;
}

}  // namespace reident::identification
