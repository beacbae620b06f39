// One batch of frames on its way into the tables. Private to storage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "storage/archive/archive.hpp"
#include "storage/archive/sequence.hpp"
#include "storage/archive/writer.hpp"
#include "storage/database/sqlite.hpp"

namespace reident::storage {

/// Late samples of a series no further apart than this are marked as one range.
inline constexpr Time late_merge_distance = 600 * second_ns;

/// Used once, within a transaction of the caller.
class Append {
 public:
  /// Frames that waited for a shard (PostponedSamples) were counted when they came.
  enum class Frames { new_ones, postponed };

  Append(sqlite::Connection& connection, Writer& writer, std::span<const TelemetryFrame> frames,
         Frames which = Frames::new_ones)
      : connection_(connection), writer_(writer), frames_(frames), which_(which) {}
  AppendReport run();

 private:
  struct Arrival {
    double value;
    std::uint32_t frame;
    Quality quality;
  };
  struct Source {
    std::uint64_t frames = 0, samples = 0, duplicates = 0, conflicts = 0, late = 0, non_finite = 0;
    SequenceTracker tracker;
  };
  struct SeriesArrivals {
    const TelemetryFrame* first_frame = nullptr;
    std::uint32_t parameter = 0;
    std::vector<Arrival> arrivals{};
  };
  /// Series of one spacecraft and origin. Frames of a source mostly have the same parameters in the
  /// same order: `last` has the series of the frame before.
  struct Stream {
    std::unordered_map<std::uint32_t, std::size_t> index;
    std::vector<std::pair<std::uint32_t, std::size_t>> last;
  };
  using StreamKey = std::tuple<std::string_view, Origin, std::string_view>;

  void sort_by_series();
  std::size_t series_of(Stream& stream, const TelemetryFrame& frame, std::size_t position);
  std::size_t source_of(const TelemetryFrame& frame);
  Time time_of(const Arrival& arrival) const { return frames_[arrival.frame].generation_time; }
  Source& source_of(const Arrival& arrival) { return sources_[frame_source_[arrival.frame]]; }
  void store(const SeriesArrivals& series);
  /// Both give what landed or changed, ascending in time; `replaced` gets what was there before.
  SampleColumns all_new(const SeriesArrivals& series);
  SampleColumns settled(const SeriesArrivals& series, SeriesHead& head, SampleColumns& replaced);
  /// A file that is imported contradicts nothing, for what was received stands; nor does a
  /// simulator, which may be run twice over the same time.
  bool contradicts(const Held& kept, const Arrival& arrival) const;
  std::optional<Held> held(const SeriesHead& head, Time time);
  void save(SeriesHead& head, SampleColumns&& landed);
  std::optional<Time> sealed_until(const std::string& spacecraft);
  void mark_late(std::int64_t series, std::span<const Time> changed);
  void keep_what_was(std::int64_t series, std::span<const Time> changed,
                     const SampleColumns& replaced);
  void add_late_range(std::int64_t series, TimeRange range);
  void track_sequences();
  void save(const Source& source);
  void postpone(const SeriesHead& head, const Arrival& arrival, const ShardError& why);

  sqlite::Connection& connection_;
  Writer& writer_;
  std::span<const TelemetryFrame> frames_;
  const Frames which_;
  const std::int64_t batch_ = writer_.recent().next_batch();
  AppendReport report_;
  std::vector<Source> sources_;
  std::map<StreamKey, std::size_t> source_index_;
  std::vector<std::size_t> frame_source_;
  std::vector<std::uint8_t> frame_is_new_;  // brought a sample that was not known
  std::vector<SeriesArrivals> series_;
  std::map<std::string, std::optional<Time>> seals_;
};

/// Stores some of the samples that waited for a shard and are due, and adds the ranges in which
/// they landed. False when no more are due. Within a transaction of the caller.
bool append_postponed(sqlite::Connection& connection, Writer& writer,
                      std::vector<AppendReport::Touched>& touched);

}  // namespace reident::storage
