#include "storage/chunks/value_codec.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

namespace reident::storage {
namespace {

constexpr std::int64_t exception = -1;
// The table of this many levels, or of one in so many values, costs enough to look for a formula
// that needs none.
constexpr std::size_t many_levels = 256;
constexpr std::size_t dense_levels = 16;

// Modulo 2^64: two orders can be further apart than an int64 holds.
std::int64_t sum(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
std::int64_t difference(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

}  // namespace

void ValueEncoder::find_levels(std::span<const double> values) {
  levels_.clear();
  level_of_.resize(values.size());
  const std::size_t size = std::bit_ceil(2 * values.size());
  const int shift = 64 - std::countr_zero(size);
  buckets_.assign(size, 0);  // 1 + level, 0 where none is
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto bits = std::bit_cast<std::uint64_t>(values[i]);
    if (i > 0 && bits == before) {
      level_of_[i] = level_of_[i - 1];
      continue;
    }
    before = bits;
    std::size_t bucket = (bits * 0x9E3779B97F4A7C15) >> shift;  // Fibonacci hashing
    while (buckets_[bucket] != 0 &&
           std::bit_cast<std::uint64_t>(levels_[buckets_[bucket] - 1]) != bits)
      bucket = (bucket + 1) & (size - 1);
    if (buckets_[bucket] == 0) {
      levels_.push_back(values[i]);
      buckets_[bucket] = static_cast<std::uint32_t>(levels_.size());
    }
    level_of_[i] = buckets_[bucket] - 1;
  }
}

/// Sorts the levels and sets those aside that no formula gives.
void ValueEncoder::split_levels() {
  sorted_.resize(levels_.size());
  std::iota(sorted_.begin(), sorted_.end(), 0U);
  std::sort(sorted_.begin(), sorted_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return order_of(levels_[a]) < order_of(levels_[b]);
  });
  slot_of_.assign(levels_.size(), exception);
  countable_.clear();
  for (const std::uint32_t level : sorted_) {
    if (!is_countable(levels_[level])) continue;
    slot_of_[level] = static_cast<std::int64_t>(countable_.size());
    countable_.push_back(levels_[level]);
  }
}

ValueScheme ValueEncoder::put(std::span<const double> values, std::vector<std::uint8_t>& out) {
  find_levels(values);
  split_levels();
  best_.clear();
  if (!countable_.empty()) put_steps(values.size());
  // Bits need not be tried where a formula explains them.
  const bool dense = levels_.size() > values.size() / dense_levels;
  if (best_.empty() || (best_scheme_ == ValueScheme::table && dense)) put_bits(values);
  out.insert(out.end(), best_.begin(), best_.end());
  return best_scheme_;
}

void ValueEncoder::put_steps(std::size_t count) {
  const std::optional<DecimalSteps> decimal = find_decimal_steps(countable_);
  const std::optional<AffineSteps> near = find_near_steps(countable_);
  if (decimal)
    put_decimal(*decimal);
  else if (near && levels_.size() > std::max(many_levels, count / dense_levels))
    if (const auto affine = find_affine_steps(countable_, *near)) put_affine(*affine);
  put_table(near);
}

void ValueEncoder::consider(ValueScheme scheme) {
  if (!best_.empty() && candidate_.size() >= best_.size()) return;
  best_.swap(candidate_);
  best_scheme_ = scheme;
}

void ValueEncoder::put_decimal(const DecimalSteps& steps) {
  candidate_.assign(
      {static_cast<std::uint8_t>(ValueScheme::decimal), static_cast<std::uint8_t>(steps.decimals)});
  put_numbers(steps.numbers);
  consider(ValueScheme::decimal);
}

void ValueEncoder::put_affine(const AffineSteps& steps) {
  candidate_.assign({static_cast<std::uint8_t>(ValueScheme::affine)});
  ByteWriter writer(candidate_);
  writer.real(steps.offset);
  writer.real(steps.step);
  put_numbers(steps.numbers);
  consider(ValueScheme::affine);
}

void ValueEncoder::put_table(const std::optional<AffineSteps>& near) {
  candidate_.assign({static_cast<std::uint8_t>(ValueScheme::table)});
  ByteWriter writer(candidate_);
  writer.varint(countable_.size());
  writer.real(countable_[0]);
  writer.real(near ? near->step : 0);
  if (near) integers_.put(near->numbers, candidate_);
  numbers_.resize(countable_.size());
  for (std::size_t i = 0; i < countable_.size(); ++i) {
    const double expected =
        near ? affine_value(near->numbers[i], near->offset, near->step) : countable_[0];
    numbers_[i] = difference(order_of(countable_[i]), order_of(expected));
  }
  integers_.put(numbers_, candidate_);
  std::vector<std::int64_t> ranks(countable_.size());
  std::iota(ranks.begin(), ranks.end(), 0);
  put_numbers(ranks);
  consider(ValueScheme::table);
}

void ValueEncoder::put_bits(std::span<const double> values) {
  candidate_.assign({static_cast<std::uint8_t>(ValueScheme::bits)});
  numbers_.resize(values.size());
  std::transform(values.begin(), values.end(), numbers_.begin(), order_of);
  integers_.put(numbers_, candidate_);
  consider(ValueScheme::bits);
}

/// Values by the numbers of their levels; those without one repeat the number before them and are
/// listed.
void ValueEncoder::put_numbers(std::span<const std::int64_t> of_level) {
  positions_.clear();
  numbers_.resize(level_of_.size());
  std::int64_t before = of_level[0];
  for (std::size_t i = 0; i < level_of_.size(); ++i) {
    const std::int64_t slot = slot_of_[level_of_[i]];
    if (slot == exception)
      positions_.push_back(static_cast<std::int64_t>(i));
    else
      before = of_level[static_cast<std::size_t>(slot)];
    numbers_[i] = before;
  }
  ByteWriter(candidate_).varint(positions_.size());
  if (!positions_.empty()) put_exceptions();
  integers_.put(numbers_, candidate_);
}

void ValueEncoder::put_exceptions() {
  integers_.put(positions_, candidate_);
  std::vector<std::int64_t> bits;
  for (const std::int64_t position : positions_)
    bits.push_back(order_of(levels_[level_of_[static_cast<std::size_t>(position)]]));
  integers_.put(bits, candidate_);
}

bool ValueDecoder::get_table(ByteReader& in, std::size_t count) {
  const std::uint64_t levels = in.varint();
  const double origin = in.real();
  const double step = in.real();
  if (in.failed() || levels == 0 || levels > count) return false;
  table_.assign(levels, origin);
  numbers_.resize(levels);
  if (step != 0) {
    if (!integers_.get(in, levels, 0, numbers_)) return false;
    for (std::size_t i = 0; i < levels; ++i) table_[i] = affine_value(numbers_[i], origin, step);
  }
  if (!integers_.get(in, levels, 0, numbers_)) return false;
  for (std::size_t i = 0; i < levels; ++i)
    table_[i] = from_order(sum(order_of(table_[i]), numbers_[i]));
  return true;
}

bool ValueDecoder::get_exceptions(ByteReader& in, std::size_t count) {
  const std::uint64_t exceptions = in.varint();
  if (in.failed() || exceptions > count) return false;
  positions_.resize(exceptions);
  bits_.resize(exceptions);
  if (exceptions == 0) return true;
  return integers_.get(in, exceptions, 0, positions_) && integers_.get(in, exceptions, 0, bits_);
}

/// Values from numbers_, by a function of one number.
template <class Function>
void ValueDecoder::fill(std::span<double> out, Function value_of) const {
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = value_of(numbers_[i]);
}

void ValueDecoder::patch(std::size_t first, std::span<double> out) const {
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    const auto position = static_cast<std::uint64_t>(positions_[i]);
    if (position >= first && position - first < out.size())
      out[position - first] = from_order(bits_[i]);
  }
}

bool ValueDecoder::get(ByteReader& in, std::size_t count, std::size_t first,
                       std::span<double> out) {
  const auto scheme = static_cast<ValueScheme>(in.byte());
  if (in.failed() || scheme > ValueScheme::bits) return false;
  std::uint8_t decimals = 0;
  double offset = 0;
  double step = 0;
  if (scheme == ValueScheme::decimal) decimals = in.byte();
  if (decimals > most_decimals) return false;
  if (scheme == ValueScheme::affine) {
    offset = in.real();
    step = in.real();
  }
  if (scheme == ValueScheme::table && !get_table(in, count)) return false;
  positions_.clear();
  if (scheme != ValueScheme::bits && !get_exceptions(in, count)) return false;
  numbers_.resize(out.size());
  if (!integers_.get(in, count, first, numbers_)) return false;

  bool in_table = true;
  switch (scheme) {
    case ValueScheme::decimal:
      fill(out,
           [power = power_of_ten(decimals)](std::int64_t n) { return decimal_value(n, power); });
      break;
    case ValueScheme::affine:
      fill(out, [=](std::int64_t n) { return affine_value(n, offset, step); });
      break;
    case ValueScheme::table:
      fill(out, [&, size = table_.size()](std::int64_t n) {
        const auto rank = static_cast<std::uint64_t>(n);
        in_table &= rank < size;
        return table_[rank < size ? rank : 0];
      });
      break;
    case ValueScheme::bits:
      fill(out, from_order);
  }
  patch(first, out);
  return in_table;
}

}  // namespace reident::storage
