#include "storage/chunks/fragment.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>

#include "storage/chunks/bytes.hpp"
#include "storage/chunks/checksum.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

constexpr std::uint8_t version = 1;
constexpr std::uint8_t one_step = 1, one_quality = 2, one_source = 4, every_flag = 7;
constexpr std::size_t checksum_bytes = 8;
static_assert(std::endian::native == std::endian::little, "values are copied as they lie");

std::uint64_t difference(std::span<const Time> time, std::size_t i) {
  return static_cast<std::uint64_t>(time[i]) - static_cast<std::uint64_t>(time[i - 1]);
}

std::uint8_t flags_of(const ChunkSamples& samples) {
  const auto all_equal = [](const auto& column) {
    return std::adjacent_find(column.begin(), column.end(), std::not_equal_to<>()) == column.end();
  };
  bool steady = true;
  for (std::size_t i = 2; i < samples.time.size() && steady; ++i)
    steady = difference(samples.time, i) == difference(samples.time, 1);
  return static_cast<std::uint8_t>((steady ? one_step : 0) |
                                   (all_equal(samples.quality) ? one_quality : 0) |
                                   (all_equal(samples.source) ? one_source : 0));
}

/// A fragment laid open: the columns still in their bytes, but for the times.
struct Fragment {
  std::vector<Time> time;
  Bytes value;
  std::vector<Quality> quality;
  std::vector<std::int64_t> source;
};

ChunkError damaged(const char* how) {
  return {ChunkError::Kind::damaged, how};
}

bool read_times(ByteReader& in, bool steady, std::size_t count, std::vector<Time>& time) {
  time.push_back(static_cast<Time>(in.fixed(8)));
  const std::uint64_t step = steady && count > 1 ? in.varint() : 0;
  for (std::size_t i = 1; i < count && !in.failed(); ++i) {
    const Time next =
        static_cast<Time>(static_cast<std::uint64_t>(time.back()) + (steady ? step : in.varint()));
    if (next <= time.back()) return false;
    time.push_back(next);
  }
  return !in.failed();
}

std::optional<ChunkError> read_fragment(Bytes bytes, Fragment& fragment) {
  if (bytes.size() < checksum_bytes + 3) return damaged("is cut short");
  const Bytes body = bytes.first(bytes.size() - checksum_bytes);
  if (ByteReader(bytes.subspan(body.size())).fixed(8) != xxh64(body))
    return damaged("does not match its checksum");
  ByteReader in(body);
  if (const std::uint8_t its_version = in.byte(); its_version != version)
    return ChunkError{ChunkError::Kind::newer, "has format " + std::to_string(its_version) +
                                                   " where this program reads " +
                                                   std::to_string(version)};
  const std::uint8_t flags = in.byte();
  const std::uint64_t count = in.varint();
  if (flags > every_flag || count == 0 || count > most_samples)
    return damaged("claims what no fragment has");
  const auto samples = static_cast<std::size_t>(count);
  if (!read_times(in, (flags & one_step) != 0, samples, fragment.time))
    return damaged("has times that do not ascend");
  fragment.value = in.bytes(count * sizeof(double));
  for (std::size_t i = 0; i < ((flags & one_quality) != 0 ? 1 : samples); ++i) {
    const auto quality = quality_of_wire(in.byte());
    if (!quality) return damaged("has a quality that is none");
    fragment.quality.push_back(*quality);
  }
  for (std::size_t i = 0; i < ((flags & one_source) != 0 ? 1 : samples); ++i)
    fragment.source.push_back(from_zigzag(in.varint()));
  if (in.failed() || !in.at_end()) return damaged("has another length than it says");
  return std::nullopt;
}

}  // namespace

void encode_fragment(const ChunkSamples& samples, std::vector<std::uint8_t>& out) {
  const std::size_t count = samples.time.size(), start = out.size();
  assert(count > 0 && count <= most_samples && samples.value.size() == count &&
         samples.quality.size() == count && samples.source.size() == count);
  const std::uint8_t flags = flags_of(samples);
  ByteWriter writer(out);
  writer.byte(version);
  writer.byte(flags);
  writer.varint(count);
  writer.fixed(static_cast<std::uint64_t>(samples.time[0]), 8);
  for (std::size_t i = 1; i < ((flags & one_step) != 0 ? std::min<std::size_t>(count, 2) : count);
       ++i)
    writer.varint(difference(samples.time, i));
  writer.bytes(
      {reinterpret_cast<const std::uint8_t*>(samples.value.data()), samples.value.size_bytes()});
  for (const Quality quality : samples.quality.first((flags & one_quality) != 0 ? 1 : count))
    writer.byte(wire_value(quality));
  for (const std::int64_t source : samples.source.first((flags & one_source) != 0 ? 1 : count))
    writer.varint(zigzag(source));
  writer.fixed(xxh64(Bytes(out).subspan(start)), checksum_bytes);
}

std::optional<ChunkError> decode_fragment(Bytes bytes, TimeRange range, const ChunkTarget& target) {
  Fragment fragment;
  if (auto error = read_fragment(bytes, fragment)) return error;
  const auto first = std::lower_bound(fragment.time.begin(), fragment.time.end(), range.begin);
  const bool to_the_end = range.end == latest_time;
  const auto last =
      to_the_end ? fragment.time.end() : std::lower_bound(first, fragment.time.end(), range.end);
  const auto begin = static_cast<std::size_t>(first - fragment.time.begin());
  const auto count = static_cast<std::size_t>(std::max<std::ptrdiff_t>(last - first, 0));
  const auto copy = [begin, count](const auto& from, auto* to) {
    if (to == nullptr) return;
    if (from.size() == 1)
      to->insert(to->end(), count, from.front());
    else
      to->insert(to->end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
                 from.begin() + static_cast<std::ptrdiff_t>(begin + count));
  };
  if (count == 0) return std::nullopt;
  if (target.time != nullptr) target.time->insert(target.time->end(), first, last);
  if (target.value != nullptr) {
    target.value->resize(target.value->size() + count);
    std::memcpy(target.value->data() + (target.value->size() - count),
                fragment.value.data() + begin * sizeof(double), count * sizeof(double));
  }
  copy(fragment.quality, target.quality);
  copy(fragment.source, target.source);
  return std::nullopt;
}

}  // namespace reident::storage
