// A column chunk: many samples of one parameter in few bytes.
//
// A chunk holds 1 to `most_samples` samples, ascending in time and without two at one time. Every
// bit of them comes back. It starts with a summary that tells what is inside without decoding it,
// and checksums (XXH64) tell damage. Bytes from anywhere may be read: what is not a whole chunk
// gives an error, never more memory than stated here. CHUNK.md has the format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "storage/chunks/integer_codec.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/telemetry.hpp"
#include "storage/chunks/value_codec.hpp"

namespace reident::storage {

/// What can be known from the first `bytes` bytes of a chunk.
struct ChunkSummary {
  static constexpr std::size_t bytes = 80;

  std::uint32_t count = 0;
  Time first_time = 0;
  Time last_time = 0;
  double least = 0;  // of all values but NaN; above `greatest` where there is no other
  double greatest = 0;
  double first_value = 0;
  double last_value = 0;
};

struct ChunkError {
  enum class Kind {
    damaged,  // not a chunk, cut short, or changed
    newer     // written by a newer program
  };
  Kind kind = Kind::damaged;
  std::string message;  // what is wrong, to follow "the chunk of V_BUS at 12:00 "
};

inline constexpr std::size_t most_samples = 131072;

/// Reads the summary of the chunk that starts with `bytes`, and checks the summary alone.
std::variant<ChunkSummary, ChunkError> read_summary(std::span<const std::uint8_t> bytes);

/// One thread at a time; keeps its memory between chunks.
class ChunkEncoder {
 public:
  /// Levels 1 (fast) to 22 (small) of zstd.
  explicit ChunkEncoder(int level = default_level);

  /// Bytes of each part, for those who tune.
  struct Sizes {
    std::size_t time = 0;
    std::size_t value = 0;
    std::size_t quality = 0;
    std::size_t source = 0;
    ValueScheme scheme = ValueScheme::bits;
  };

  std::vector<std::uint8_t> encode(const ChunkSamples& samples);
  /// Of the last chunk.
  const Sizes& sizes() const { return sizes_; }

  static constexpr int default_level = 1;

 private:
  std::size_t put_part(std::vector<std::uint8_t>& body);

  IntegerEncoder integers_;
  ValueEncoder values_;
  std::vector<std::int64_t> numbers_;
  std::vector<std::uint8_t> part_;
  Sizes sizes_;
};

/// One thread at a time; keeps its memory between chunks: at most 20 MiB, whatever it is given.
class ChunkDecoder {
 public:
  ChunkDecoder() : values_(integers_) {}

  /// Appends the samples with a time in `range`, all by default. After an error the target is as it
  /// was. Times are always decoded, values only where the range meets the chunk.
  std::optional<ChunkError> decode(std::span<const std::uint8_t> bytes, const ChunkTarget& target);
  std::optional<ChunkError> decode(std::span<const std::uint8_t> bytes, TimeRange range,
                                   const ChunkTarget& target);

 private:
  struct Selection {
    std::size_t of = 0;     // samples in the chunk
    std::size_t first = 0;  // wanted ones
    std::size_t count = 0;
  };
  /// Which of the samples lie in the range; appends their times to `out`, if there is one. Absent
  /// where the times do not ascend from the first to the last of the summary.
  std::optional<Selection> decode_times(Bytes part, const ChunkSummary& summary, TimeRange range,
                                        std::vector<Time>* out);
  static Selection steady_times(const ChunkSummary& summary, std::uint64_t step, TimeRange range,
                                std::vector<Time>* out);
  bool decode_values(Bytes part, Selection wanted, std::vector<double>& out);
  bool decode_qualities(Bytes part, Selection wanted, std::vector<Quality>& out);
  bool decode_sources(Bytes part, Selection wanted, std::vector<std::int64_t>& out);

  IntegerDecoder integers_;
  ValueDecoder values_;
  std::vector<std::int64_t> times_, numbers_;
};

}  // namespace reident::storage
