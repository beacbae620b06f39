#include "storage/chunks/integer_codec.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace reident::storage {
namespace {

constexpr std::uint8_t order_bits = 3;
constexpr std::uint8_t runs_bit = 4;
constexpr int orders = 3;
// The estimate does not see what zstd finds in repeated patterns: this many of the best are tried.
constexpr std::size_t tried_forms = 2;

std::uint64_t bits_of(std::int64_t number) {
  return static_cast<std::uint64_t>(number);
}

int width_of(std::span<const std::uint64_t> words) {
  std::uint64_t any = 0;
  for (const std::uint64_t word : words) any |= word;
  return static_cast<int>((std::bit_width(any) + 7) / 8);
}

/// Bytes that the planes need if each byte stands alone.
double entropy(std::span<const std::uint64_t> words) {
  const double total = static_cast<double>(words.size());
  const int width = width_of(words);
  double bits = 0;
  for (int plane = 0; plane < width; ++plane) {
    std::array<std::uint32_t, 256> histogram{};
    for (const std::uint64_t word : words) ++histogram[(word >> (8 * plane)) & 0xFF];
    for (const std::uint32_t times : histogram)
      if (times > 0) bits += times * std::log2(total / times);
  }
  return bits / 8;
}

/// The greatest number that divides every distance to `base`, the smallest of them; 1 if all are
/// the same.
std::uint64_t unit_of(std::span<const std::int64_t> numbers, std::int64_t base) {
  std::uint64_t unit = 0;
  std::int64_t before = base;
  for (const std::int64_t number : numbers) {
    if (number == before) continue;
    before = number;
    unit = std::gcd(unit, bits_of(number) - bits_of(base));
    if (unit == 1) break;
  }
  return std::max<std::uint64_t>(unit, 1);
}

/// What differences alone do not say.
struct Start {
  std::uint64_t y = 0;      // orders 1 and 2
  std::uint64_t slope = 0;  // order 2
};

Start start_of(std::span<const std::uint64_t> ys) {
  return {.y = ys[0], .slope = ys.size() > 1 ? ys[1] - ys[0] : 0};
}

void differences(std::span<const std::uint64_t> ys, int order, std::vector<std::uint64_t>& words) {
  words.assign(ys.begin(), ys.end());
  if (order == 0) return;
  Start expected = start_of(ys);
  if (order == 1) expected.slope = 0;
  words[0] = 0;
  for (std::size_t i = 1; i < ys.size(); ++i) {
    const std::uint64_t step = ys[i] - ys[i - 1];
    words[i] = zigzag(static_cast<std::int64_t>(step - expected.slope));
    if (order == 2) expected.slope = step;
  }
}

/// The inverse of differences(), in place.
void sum_up(std::span<std::uint64_t> words, int order, Start start) {
  if (order == 1)
    for (std::uint64_t& word : words) word = start.y += bits_of(from_zigzag(word));
  if (order == 2 && !words.empty()) {
    words[0] = start.y;
    for (std::uint64_t& word : words.subspan(1))
      word = start.y += start.slope += bits_of(from_zigzag(word));
  }
}

}  // namespace

void IntegerEncoder::scale(std::span<const std::int64_t> numbers) {
  base_ = *std::min_element(numbers.begin(), numbers.end());
  unit_ = unit_of(numbers, base_);
  ys_.resize(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) ys_[i] = bits_of(numbers[i]) - bits_of(base_);
  if (unit_ == 1) return;
  for (std::uint64_t& y : ys_) y /= unit_;
}

void IntegerEncoder::fold() {
  heads_.clear();
  lengths_.clear();
  for (const std::uint64_t y : ys_) {
    if (!heads_.empty() && heads_.back() == y) {
      ++lengths_.back();
    } else {
      heads_.push_back(y);
      lengths_.push_back(0);
    }
  }
}

void IntegerEncoder::plan(bool runs) {
  const double lengths = runs ? entropy(lengths_) : 0;
  for (int order = 0; order < orders; ++order) {
    differences(runs ? heads_ : ys_, order, words_);
    forms_.push_back({runs, order, entropy(words_) + lengths});
  }
}

void IntegerEncoder::put(std::span<const std::int64_t> numbers, std::vector<std::uint8_t>& out) {
  scale(numbers);
  fold();
  forms_.clear();
  // Where hardly anything repeats runs cost more than they save, and where nearly all does there is
  // nothing better.
  if (heads_.size() > numbers.size() / 8) plan(false);
  if (heads_.size() <= numbers.size() - numbers.size() / 8) plan(true);
  const std::size_t tried = std::min(tried_forms, forms_.size());
  std::partial_sort(forms_.begin(), forms_.begin() + static_cast<std::ptrdiff_t>(tried),
                    forms_.end(),
                    [](const Form& a, const Form& b) { return a.estimate < b.estimate; });
  best_.clear();
  for (std::size_t i = 0; i < tried; ++i) {
    candidate_.clear();
    put_form(forms_[i], candidate_);
    if (best_.empty() || candidate_.size() < best_.size()) best_.swap(candidate_);
  }
  out.insert(out.end(), best_.begin(), best_.end());
}

void IntegerEncoder::put_form(const Form& form, std::vector<std::uint8_t>& out) {
  const std::vector<std::uint64_t>& ys = form.runs ? heads_ : ys_;
  const Start start = start_of(ys);
  ByteWriter writer(out);
  writer.byte(static_cast<std::uint8_t>(form.order | (form.runs ? runs_bit : 0)));
  if (form.runs) writer.varint(heads_.size());
  writer.varint(zigzag(base_));
  writer.varint(unit_);
  if (form.order > 0) writer.varint(start.y);
  if (form.order == 2) writer.varint(zigzag(static_cast<std::int64_t>(start.slope)));
  differences(ys, form.order, words_);
  put_planes(words_, out);
  if (form.runs) put_planes(lengths_, out);
}

void IntegerEncoder::put_planes(std::span<const std::uint64_t> words,
                                std::vector<std::uint8_t>& out) {
  const int width = width_of(words);
  ByteWriter(out).byte(static_cast<std::uint8_t>(width));
  if (width == 0) return;
  planes_.clear();
  for (int plane = 0; plane < width; ++plane)
    for (const std::uint64_t word : words)
      planes_.push_back(static_cast<std::uint8_t>(word >> (8 * plane)));
  compressor_.put(planes_, out);
}

bool IntegerDecoder::get_planes(ByteReader& in, std::size_t count,
                                std::vector<std::uint64_t>& words) {
  const std::size_t width = in.byte();
  if (in.failed() || width > 8) return false;
  words.resize(count);
  if (width == 0) {
    std::fill(words.begin(), words.end(), 0);
    return true;
  }
  planes_.resize(width * count);
  if (!decompressor_.get(in, planes_)) return false;
  for (std::size_t i = 0; i < count; ++i) words[i] = planes_[i];
  for (std::size_t plane = 1; plane < width; ++plane) {
    const std::uint8_t* bytes = planes_.data() + plane * count;
    for (std::size_t i = 0; i < count; ++i) words[i] |= std::uint64_t{bytes[i]} << (8 * plane);
  }
  return true;
}

std::optional<std::int64_t> IntegerDecoder::get_constant(ByteReader& in, std::size_t count) {
  ByteReader ahead = in;
  const std::uint8_t form = ahead.byte();
  const bool is_run = form == runs_bit && ahead.varint() == 1;
  const std::int64_t base = from_zigzag(ahead.varint());
  ahead.varint();  // whatever the unit: the word is 0
  const bool is_constant = (form == 0 || is_run) && ahead.byte() == 0;
  std::uint64_t length = count - 1;
  if (is_run) {
    const std::uint8_t width = ahead.byte();
    if (width > 8 || (width > 0 && ahead.varint() != 2U * width)) return std::nullopt;
    length = ahead.fixed(width);
  }
  if (!is_constant || ahead.failed() || length != count - 1) return std::nullopt;
  in = ahead;
  return base;
}

bool IntegerDecoder::get(ByteReader& in, std::size_t count, std::size_t first,
                         std::span<std::int64_t> out) {
  if (const auto constant = count > 0 ? get_constant(in, count) : std::nullopt) {
    std::fill(out.begin(), out.end(), *constant);
    return true;
  }
  const std::uint8_t form = in.byte();
  const int order = form & order_bits;
  const bool runs = (form & runs_bit) != 0;
  const std::uint64_t heads = runs ? in.varint() : count;
  const std::uint64_t base = bits_of(from_zigzag(in.varint()));
  const std::uint64_t unit = in.varint();
  Start start;
  if (order > 0) start.y = in.varint();
  if (order == 2) start.slope = bits_of(from_zigzag(in.varint()));
  if (in.failed() || order >= orders || form > (order_bits | runs_bit) || heads > count)
    return false;
  if (!get_planes(in, heads, words_)) return false;
  if (runs && !get_planes(in, heads, lengths_)) return false;
  const std::size_t end = first + out.size();
  sum_up(std::span(words_).first(runs ? heads : end), order, start);
  const auto number = [&](std::size_t i) {
    return static_cast<std::int64_t>(base + unit * words_[i]);
  };
  if (!runs) {
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = number(first + i);
    return true;
  }
  std::size_t at = 0;
  for (std::size_t head = 0; head < heads; ++head) {
    if (lengths_[head] >= count - at) return false;
    const std::size_t next = at + lengths_[head] + 1;
    const std::size_t from = std::max(at, first);
    if (from < std::min(next, end))
      std::fill_n(out.begin() + static_cast<std::ptrdiff_t>(from - first),
                  std::min(next, end) - from, number(head));
    at = next;
  }
  return at == count;
}

}  // namespace reident::storage
