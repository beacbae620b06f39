// One batch of frames on its way into the tables. Private to storage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "storage/archive.hpp"
#include "storage/sequence.hpp"
#include "storage/sqlite.hpp"

namespace reident::storage {

/// Just after `time`, for the end of a range.
constexpr Time just_after(Time time) {
  return time == std::numeric_limits<Time>::max() ? time : time + 1;
}

/// Late samples of a series no further apart than this are marked as one range.
inline constexpr Time late_merge_distance = Time{600} * 1'000'000'000;

/// Used once, within a transaction of the caller.
class Append {
 public:
  Append(sqlite::Connection& connection, std::span<const TelemetryFrame> frames)
      : connection_(connection), frames_(frames) {}
  AppendReport run();

 private:
  struct Arrival {
    const Sample* sample;
    std::uint32_t frame;
  };
  struct Source {
    std::uint64_t frames = 0, samples = 0, duplicates = 0, conflicts = 0, late = 0, non_finite = 0;
    SequenceTracker tracker;
  };
  struct SeriesState {
    std::string_view spacecraft;
    Origin origin = Origin::real;
    std::uint32_t parameter = 0;
    std::vector<Arrival> arrivals{};

    std::int64_t id = 0;
    std::uint64_t samples = 0;
    std::optional<Time> first{}, last{};
    std::vector<Time> changed{};  // times at which samples landed or changed
  };
  using StreamKey = std::tuple<std::string_view, Origin, std::string_view>;

  void sort_by_series();
  std::size_t source_of(const TelemetryFrame& frame);
  void load(SeriesState& series);
  void store(SeriesState& series);
  bool store_one(SeriesState& series, const Arrival& arrival, sqlite::Query& insert);
  bool settle_collision(const SeriesState& series, Time time, double value, Quality quality,
                        Source& source);
  void save(const SeriesState& series);
  void mark_late(const SeriesState& series);
  void add_late_range(std::int64_t series, TimeRange range);
  void track_sequences();
  void save(const Source& source);

  sqlite::Connection& connection_;
  std::span<const TelemetryFrame> frames_;
  AppendReport report_;
  std::vector<Source> sources_;
  std::map<StreamKey, std::size_t> source_index_;
  std::vector<std::size_t> frame_source_;
  std::vector<bool> frame_is_new_;  // brought a sample that was not known
  std::vector<SeriesState> series_;
};

}  // namespace reident::storage
