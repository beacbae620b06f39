// A column chunk: many samples of one parameter in few bytes.
//
// A chunk holds 1 to `most_samples` samples, ascending in time and without two at one time. Every
// bit of them comes back. It starts with a summary that shows what is inside without decoding it,
// and checksums (XXH64) show damage. Bytes from anywhere may be read: what is not a whole chunk
// gives an error, never more memory than stated here. CHUNK.md has the format.
//
// Damage is returned as a ChunkError, not thrown. Encoder and decoder throw std::bad_alloc where
// there is no memory, and nothing else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "storage/chunks/integer_codec.hpp"
#include "storage/chunks/value_codec.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// What can be known from the first `bytes` bytes of a chunk. Times are generation times [ns], both
/// included; values are in the parameter's unit.
struct ChunkSummary {
  static constexpr std::size_t bytes = 80;

  std::uint32_t count = 0;  // samples
  Time first_time = 0;
  Time last_time = 0;
  /// Bounds of all values but NaN; `least` is above `greatest` where there is no other.
  double least = 0;
  double greatest = 0;
  /// By time; NaN where that sample is.
  double first_value = 0;
  double last_value = 0;
};

/// Why bytes are not a chunk that this program reads.
struct ChunkError {
  enum class Kind {
    damaged,  // not a chunk, cut short, or changed
    newer     // written by a newer program
  };
  Kind kind = Kind::damaged;
  /// What is wrong, to follow "the chunk of V_BUS at 12:00 ".
  std::string message;
};

/// The most samples that a chunk or a fragment holds.
inline constexpr std::size_t most_samples = 131072;

/// Reads the summary of the chunk that starts with `bytes`, of which there are at least
/// ChunkSummary::bytes in a whole one. Checks the summary alone: the body may be damaged, or may
/// not be there. Returns the summary, or what is wrong with it.
std::variant<ChunkSummary, ChunkError> read_summary(std::span<const std::uint8_t> bytes);

/// Makes chunks, of any parameters one after the other. One thread at a time; keeps its memory
/// between chunks.
class ChunkEncoder {
 public:
  /// `level` is zstd's, 1 (fast) to 22 (small). Any decoder reads what any level wrote.
  explicit ChunkEncoder(int level = default_level);

  /// Bytes of each part of a chunk with its length, and how values were coded: for those who tune.
  struct Sizes {
    std::size_t time = 0;
    std::size_t value = 0;
    std::size_t quality = 0;
    std::size_t source = 0;
    ValueScheme scheme = ValueScheme::bits;
  };

  /// Returns the bytes of one chunk with these samples. All four columns have one length, from 1 to
  /// most_samples, times strictly ascend, and qualities are known ones. The same samples give the
  /// same bytes, as long as zstd is the same.
  std::vector<std::uint8_t> encode(const ChunkSamples& samples);
  /// The sizes of the last chunk that was encoded.
  const Sizes& sizes() const { return sizes_; }

  /// Higher levels gain little for these columns (CHUNK.md, "Measured").
  static constexpr int default_level = 1;

 private:
  /// Appends the part at hand to the body and empties it. Returns the bytes that were appended.
  std::size_t put_part(std::vector<std::uint8_t>& body);

  IntegerEncoder integers_;
  ValueEncoder values_;
  std::vector<std::int64_t> numbers_;
  std::vector<std::uint8_t> part_;
  Sizes sizes_;
};

/// Reads chunks, of any parameters one after the other. One thread at a time; keeps its memory
/// between chunks: at most 20 MiB, whatever it is given. A damaged chunk does not spoil the next
/// one.
class ChunkDecoder {
 public:
  ChunkDecoder() : values_(integers_) {}

  /// Appends the samples of a chunk with a time in `range`, all by default, to the target. `bytes`
  /// are the whole chunk and nothing else. Times are always decoded and checked; the other columns
  /// only where the range meets the chunk. Returns what is wrong with the bytes; then the target is
  /// as it was. Absent where they were decoded.
  std::optional<ChunkError> decode(std::span<const std::uint8_t> bytes, const ChunkTarget& target);
  std::optional<ChunkError> decode(std::span<const std::uint8_t> bytes, TimeRange range,
                                   const ChunkTarget& target);

 private:
  /// Which of a chunk's samples are wanted: neighbours.
  struct Selection {
    std::size_t of = 0;     // samples in the chunk
    std::size_t first = 0;  // wanted ones
    std::size_t count = 0;
  };
  /// Which of the samples lie in the range; appends their times to `out`, if there is one. Absent
  /// where the times do not ascend from the first to the last of the summary.
  std::optional<Selection> decode_times(Bytes part, const ChunkSummary& summary, TimeRange range,
                                        std::vector<Time>* out);
  /// As decode_times(), of times that stand `step` apart: they are counted, not decoded.
  static Selection steady_times(const ChunkSummary& summary, std::uint64_t step, TimeRange range,
                                std::vector<Time>* out);
  /// Each appends the wanted samples of its part to `out`. False where the part holds no such
  /// column.
  bool decode_values(Bytes part, Selection wanted, std::vector<double>& out);
  bool decode_qualities(Bytes part, Selection wanted, std::vector<Quality>& out);
  bool decode_sources(Bytes part, Selection wanted, std::vector<std::int64_t>& out);

  IntegerDecoder integers_;
  ValueDecoder values_;
  std::vector<std::int64_t> times_, numbers_;
};

}  // namespace reident::storage
