// Any bytes are either a chunk, whose samples come back when they are encoded again, or an error
// with a message that leaves the target alone. The checksums are made right first: what is tested
// is what stands behind them.
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <variant>
#include <vector>

#include "storage/chunks/checksum.hpp"
#include "storage/chunks/chunk.hpp"

namespace {

using namespace reident::storage;

using Chunk = std::vector<std::uint8_t>;

void require(bool condition) {
  if (!condition) std::abort();
}

struct Columns {
  std::vector<Time> time;
  std::vector<double> value;
  std::vector<Quality> quality;
  std::vector<std::int64_t> source;
  ChunkTarget target() { return {&time, &value, &quality, &source}; }
  ChunkSamples samples() const { return {time, value, quality, source}; }
};

bool same(const Columns& a, const Columns& b) {
  return a.time == b.time && a.quality == b.quality && a.source == b.source &&
         a.value.size() == b.value.size() &&
         (a.value.empty() ||
          std::memcmp(a.value.data(), b.value.data(), a.value.size() * sizeof(double)) == 0);
}

void put(Chunk& chunk, std::size_t at, std::uint64_t number, std::size_t width) {
  for (std::size_t i = 0; i < width; ++i)
    chunk[at + i] = static_cast<std::uint8_t>(number >> (8 * i));
}

/// The parts of the summary that are there to be checked: magic, version, length, checksums.
void seal(Chunk& chunk) {
  if (chunk.size() < ChunkSummary::bytes) return;
  put(chunk, 0, 0x6B686372, 4);
  put(chunk, 4, 1, 4);
  put(chunk, 12, chunk.size() - ChunkSummary::bytes, 4);
  put(chunk, 64, xxh64(std::span(chunk).subspan(ChunkSummary::bytes)), 8);
  put(chunk, 72, xxh64(std::span(chunk).first(72)), 8);
}

// One of each: to make zstd's tables takes longer than to use them.
ChunkEncoder& encoder() {
  static ChunkEncoder one(1);
  return one;
}
ChunkDecoder& decoder() {
  static ChunkDecoder one;
  return one;
}

void check(const Chunk& chunk) {
  Columns samples;
  if (const auto error = decoder().decode(chunk, samples.target())) {
    require(!error->message.empty() && samples.time.empty() && samples.value.empty() &&
            samples.quality.empty() && samples.source.empty());
    return;
  }
  require(samples.time.size() == std::get<ChunkSummary>(read_summary(chunk)).count);
  if (samples.time.size() > 4096) return;  // repeats itself, and takes long
  Columns again;
  require(!decoder().decode(encoder().encode(samples.samples()), again.target()));
  require(same(samples, again));
  Columns part;
  const TimeRange range{samples.time[samples.time.size() / 3],
                        samples.time[samples.time.size() * 2 / 3]};
  require(!decoder().decode(chunk, range, part.target()));
}

/// Up to 255 samples: a count, then 5 bytes for each.
Columns samples_from(std::span<const std::uint8_t>& data) {
  Columns samples;
  Time time = 0;
  const std::size_t count = 1 + data[0];
  data = data.subspan(1);
  while (samples.time.size() < count && data.size() >= 5) {
    time += 1 + (Time{data[0]} << (data[1] % 40));
    samples.time.push_back(time);
    samples.value.push_back(data[3] < 250 ? data[2] / 10.0 + data[3]
                                          : std::bit_cast<double>(std::uint64_t{data[2]} << 55));
    samples.quality.push_back(qualities[data[4] % qualities.size()]);
    samples.source.push_back(data[4] / 64);
    data = data.subspan(5);
  }
  return samples;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  std::span<const std::uint8_t> data(bytes, size);
  if (data.size() < 8) return 0;
  if (data[0] % 2 == 0) {
    Chunk chunk(data.begin() + 1, data.end());
    check(chunk);
    seal(chunk);
    check(chunk);
    return 0;
  }
  // A good chunk, changed here and there by the rest of the data: place and new byte.
  data = data.subspan(1);
  const Columns samples = samples_from(data);
  if (samples.time.empty()) return 0;
  Chunk chunk = encoder().encode(samples.samples());
  Columns back;
  require(!decoder().decode(chunk, back.target()) && same(samples, back));
  for (; data.size() >= 3; data = data.subspan(3))
    chunk[(data[0] + 256U * data[1]) % chunk.size()] = data[2];
  seal(chunk);
  check(chunk);
  return 0;
}
