#include "storage/chunks/chunk.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

#include "storage/chunks/bytes.hpp"
#include "storage/chunks/checksum.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

constexpr std::uint32_t magic = 0x6B686372;  // "rchk"
constexpr std::uint32_t version = 1;
constexpr std::size_t checked_bytes = ChunkSummary::bytes - 8;  // before the summary's checksum

struct Header {
  ChunkSummary summary;
  std::uint32_t body_bytes = 0;
  std::uint64_t body_checksum = 0;
};

ChunkError damaged(const char* how) {
  return {ChunkError::Kind::damaged, how};
}

std::variant<Header, ChunkError> read_header(Bytes bytes) {
  if (bytes.size() < ChunkSummary::bytes) return damaged("is cut short within its summary");
  ByteReader in(bytes.first(ChunkSummary::bytes));
  if (in.fixed(4) != magic) return damaged("does not start as a chunk does");
  const std::uint64_t its_version = in.fixed(4);
  Header header;
  ChunkSummary& summary = header.summary;
  summary.count = static_cast<std::uint32_t>(in.fixed(4));
  header.body_bytes = static_cast<std::uint32_t>(in.fixed(4));
  summary.first_time = static_cast<Time>(in.fixed(8));
  summary.last_time = static_cast<Time>(in.fixed(8));
  summary.least = in.real();
  summary.greatest = in.real();
  summary.first_value = in.real();
  summary.last_value = in.real();
  header.body_checksum = in.fixed(8);
  if (in.fixed(8) != xxh64(bytes.first(checked_bytes)))
    return damaged("has a summary that does not match its checksum");
  if (its_version != version)
    return ChunkError{ChunkError::Kind::newer, "has format " + std::to_string(its_version) +
                                                   " where this program reads " +
                                                   std::to_string(version)};
  if (summary.count == 0 || summary.count > most_samples)
    return damaged("claims a number of samples that no chunk has");
  return header;
}

void write_header(const Header& header, std::vector<std::uint8_t>& out) {
  const ChunkSummary& summary = header.summary;
  ByteWriter writer(out);
  writer.fixed(magic, 4);
  writer.fixed(version, 4);
  writer.fixed(summary.count, 4);
  writer.fixed(header.body_bytes, 4);
  writer.fixed(static_cast<std::uint64_t>(summary.first_time), 8);
  writer.fixed(static_cast<std::uint64_t>(summary.last_time), 8);
  writer.real(summary.least);
  writer.real(summary.greatest);
  writer.real(summary.first_value);
  writer.real(summary.last_value);
  writer.fixed(header.body_checksum, 8);
  writer.fixed(xxh64(out), 8);
}

ChunkSummary summary_of(const ChunkSamples& samples) {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -least;
  for (const double value : samples.value) {  // a NaN is neither less nor greater
    if (value < least) least = value;
    if (value > greatest) greatest = value;
  }
  return {.count = static_cast<std::uint32_t>(samples.time.size()),
          .first_time = samples.time.front(),
          .last_time = samples.time.back(),
          .least = least,
          .greatest = greatest,
          .first_value = samples.value.front(),
          .last_value = samples.value.back()};
}

/// Times from their differences, in place: times[0] is known. False unless they ascend to `last`.
bool sum_up_times(std::span<Time> times, Time last) {
  for (std::size_t i = 1; i < times.size(); ++i) {
    times[i] = static_cast<Time>(static_cast<std::uint64_t>(times[i - 1]) +
                                 static_cast<std::uint64_t>(times[i]));
    if (times[i] <= times[i - 1]) return false;
  }
  return times.back() == last;
}

/// Whether times at this step lead from the first to the last one without leaving their type.
bool is_steady(const ChunkSummary& summary, std::uint64_t step) {
  const auto span = static_cast<std::uint64_t>(summary.last_time) -
                    static_cast<std::uint64_t>(summary.first_time);
  if (summary.count == 1) return span == 0;
  return step > 0 && summary.last_time > summary.first_time && span % step == 0 &&
         span / step == summary.count - 1;
}

/// Gives the vectors their sizes back unless keep() was called.
class Restore {
 public:
  explicit Restore(const ChunkTarget& target)
      : target_(target),
        time_(target.time != nullptr ? target.time->size() : 0),
        value_(target.value != nullptr ? target.value->size() : 0),
        quality_(target.quality != nullptr ? target.quality->size() : 0),
        source_(target.source != nullptr ? target.source->size() : 0) {}
  Restore(const Restore&) = delete;
  Restore& operator=(const Restore&) = delete;
  ~Restore() {
    if (keep_) return;
    if (target_.time != nullptr) target_.time->resize(time_);
    if (target_.value != nullptr) target_.value->resize(value_);
    if (target_.quality != nullptr) target_.quality->resize(quality_);
    if (target_.source != nullptr) target_.source->resize(source_);
  }
  void keep() { keep_ = true; }

 private:
  const ChunkTarget& target_;
  std::size_t time_, value_, quality_, source_;
  bool keep_ = false;
};

}  // namespace

std::variant<ChunkSummary, ChunkError> read_summary(std::span<const std::uint8_t> bytes) {
  auto header = read_header(bytes);
  if (auto* error = std::get_if<ChunkError>(&header)) return std::move(*error);
  return std::get<Header>(header).summary;
}

ChunkEncoder::ChunkEncoder(int level) : integers_(level), values_(integers_) {}

/// Ends a part: its length, then its bytes.
std::size_t ChunkEncoder::put_part(std::vector<std::uint8_t>& body) {
  const std::size_t before = body.size();
  ByteWriter writer(body);
  writer.varint(part_.size());
  writer.bytes(part_);
  part_.clear();
  return body.size() - before;
}

std::vector<std::uint8_t> ChunkEncoder::encode(const ChunkSamples& samples) {
  const std::size_t count = samples.time.size();
  assert(count > 0 && count <= most_samples && samples.value.size() == count &&
         samples.quality.size() == count && samples.source.size() == count);
  std::vector<std::uint8_t> body;
  part_.clear();
  numbers_.clear();
  for (std::size_t i = 1; i < count; ++i) {
    assert(samples.time[i] > samples.time[i - 1]);
    numbers_.push_back(static_cast<std::int64_t>(static_cast<std::uint64_t>(samples.time[i]) -
                                                 static_cast<std::uint64_t>(samples.time[i - 1])));
  }
  if (count > 1) integers_.put(numbers_, part_);
  sizes_.time = put_part(body);
  sizes_.scheme = values_.put(samples.value, part_);
  sizes_.value = put_part(body);
  numbers_.resize(count);
  std::transform(samples.quality.begin(), samples.quality.end(), numbers_.begin(),
                 [](Quality quality) { return std::int64_t{wire_value(quality)}; });
  integers_.put(numbers_, part_);
  sizes_.quality = put_part(body);
  integers_.put(samples.source, part_);
  sizes_.source = put_part(body);

  std::vector<std::uint8_t> chunk;
  chunk.reserve(ChunkSummary::bytes + body.size());
  write_header({summary_of(samples), static_cast<std::uint32_t>(body.size()), xxh64(body)}, chunk);
  chunk.insert(chunk.end(), body.begin(), body.end());
  return chunk;
}

std::optional<ChunkError> ChunkDecoder::decode(std::span<const std::uint8_t> bytes,
                                               const ChunkTarget& target) {
  return decode(bytes, all_times, target);
}

std::optional<ChunkError> ChunkDecoder::decode(std::span<const std::uint8_t> bytes, TimeRange range,
                                               const ChunkTarget& target) {
  const auto read = read_header(bytes);
  if (const auto* error = std::get_if<ChunkError>(&read)) return *error;
  const Header& header = std::get<Header>(read);
  const Bytes body = bytes.subspan(ChunkSummary::bytes);
  if (body.size() < header.body_bytes) return damaged("is cut short");
  if (body.size() > header.body_bytes) return damaged("has bytes behind its end");
  if (xxh64(body) != header.body_checksum) return damaged("does not match its checksum");

  ByteReader parts(body);
  std::array<Bytes, 4> part;
  for (Bytes& each : part) each = parts.bytes(parts.varint());
  if (parts.failed() || !parts.at_end()) return damaged("has parts of impossible lengths");
  Restore restore(target);
  const auto selected = decode_times(part[0], header.summary, range, target.time);
  if (!selected) return damaged("has times that do not ascend");
  const Selection wanted = *selected;
  if (wanted.count == 0) return std::nullopt;
  if (target.value != nullptr && !decode_values(part[1], wanted, *target.value))
    return damaged("has values that cannot be decoded");
  if (target.quality != nullptr && !decode_qualities(part[2], wanted, *target.quality))
    return damaged("has qualities that cannot be decoded");
  if (target.source != nullptr && !decode_sources(part[3], wanted, *target.source))
    return damaged("has sources that cannot be decoded");
  restore.keep();
  return std::nullopt;
}

std::optional<ChunkDecoder::Selection> ChunkDecoder::decode_times(Bytes part,
                                                                  const ChunkSummary& summary,
                                                                  TimeRange range,
                                                                  std::vector<Time>* out) {
  ByteReader in(part);
  const auto constant = summary.count > 1 ? IntegerDecoder::get_constant(in, summary.count - 1)
                                          : std::optional<std::int64_t>(1);
  if (constant) {
    const auto step = static_cast<std::uint64_t>(*constant);
    if (!in.at_end() || !is_steady(summary, step)) return std::nullopt;
    return steady_times(summary, step, range, out);
  }
  times_.resize(summary.count);
  times_[0] = summary.first_time;
  if (!integers_.get(in, summary.count - 1, 0, std::span(times_).subspan(1)) || !in.at_end() ||
      !sum_up_times(times_, summary.last_time))
    return std::nullopt;
  const auto begin = std::lower_bound(times_.begin(), times_.end(), range.begin);
  const auto end =
      range.end == latest_time ? times_.end() : std::lower_bound(begin, times_.end(), range.end);
  if (begin >= end) return Selection{};
  if (out != nullptr) out->insert(out->end(), begin, end);
  return Selection{times_.size(), static_cast<std::size_t>(begin - times_.begin()),
                   static_cast<std::size_t>(end - begin)};
}

// Times of a steady step are counted, not decoded.
ChunkDecoder::Selection ChunkDecoder::steady_times(const ChunkSummary& summary, std::uint64_t step,
                                                   TimeRange range, std::vector<Time>* out) {
  const auto bits = [](Time time) { return static_cast<std::uint64_t>(time); };
  /// Number of samples before `time`.
  const auto before = [&](Time time) -> std::size_t {
    if (time <= summary.first_time) return 0;
    if (time > summary.last_time) return summary.count;
    return static_cast<std::size_t>((bits(time) - bits(summary.first_time) - 1) / step + 1);
  };
  const std::size_t begin = before(range.begin);
  const std::size_t end = range.end == latest_time ? summary.count : before(range.end);
  if (begin >= end) return {};
  if (out != nullptr) {
    const std::size_t old = out->size();
    out->resize(old + (end - begin));
    std::uint64_t time = bits(summary.first_time) + begin * step;
    for (std::size_t i = old; i < out->size(); ++i, time += step)
      (*out)[i] = static_cast<Time>(time);
  }
  return {summary.count, begin, end - begin};
}

bool ChunkDecoder::decode_values(Bytes part, Selection wanted, std::vector<double>& out) {
  const std::size_t before = out.size();
  out.resize(before + wanted.count);
  ByteReader in(part);
  return values_.get(in, wanted.of, wanted.first, std::span(out).subspan(before)) && in.at_end();
}

bool ChunkDecoder::decode_qualities(Bytes part, Selection wanted, std::vector<Quality>& out) {
  ByteReader in(part);
  if (const auto constant = IntegerDecoder::get_constant(in, wanted.of)) {
    const auto quality = quality_of_wire(*constant);
    if (!in.at_end() || !quality) return false;
    out.insert(out.end(), wanted.count, *quality);
    return true;
  }
  numbers_.resize(wanted.count);
  if (!integers_.get(in, wanted.of, wanted.first, numbers_) || !in.at_end()) return false;
  bool known = true;
  const std::size_t before = out.size();
  out.resize(before + wanted.count);
  for (std::size_t i = 0; i < wanted.count; ++i) {
    known &= is_wire_value(numbers_[i]);
    out[before + i] = static_cast<Quality>(numbers_[i]);
  }
  return known;
}

bool ChunkDecoder::decode_sources(Bytes part, Selection wanted, std::vector<std::int64_t>& out) {
  const std::size_t before = out.size();
  out.resize(before + wanted.count);
  ByteReader in(part);
  return integers_.get(in, wanted.of, wanted.first, std::span(out).subspan(before)) && in.at_end();
}

}  // namespace reident::storage
