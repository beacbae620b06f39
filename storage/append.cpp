#include "storage/append.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

namespace reident::storage {
namespace {

bool same_value(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

Quality quality_of(const Sample& sample) {
  return std::isfinite(sample.value) ? std::min(sample.quality, Quality::invalid)
                                     : Quality::invalid;
}

// The distance of two times can be twice as large as a Time holds.
bool are_near(Time earlier, Time later) {
  return static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier) <=
         static_cast<std::uint64_t>(late_merge_distance);
}

}  // namespace

AppendReport Append::run() {
  report_.frames = frames_.size();
  frame_is_new_.assign(frames_.size(), false);
  for (const TelemetryFrame& frame : frames_) frame_source_.push_back(source_of(frame));
  sort_by_series();
  for (SeriesState& series : series_) {
    load(series);
    store(series);
    if (series.changed.empty()) continue;
    save(series);
    mark_late(series);
    const auto [first, last] = std::minmax_element(series.changed.begin(), series.changed.end());
    report_.touched.push_back({std::string(series.spacecraft),
                               series.origin,
                               series.parameter,
                               {*first, just_after(*last)}});
  }
  track_sequences();
  for (const Source& source : sources_) save(source);
  return std::move(report_);
}

// Samples of one series lie side by side in the file; their order of arrival is kept.
void Append::sort_by_series() {
  std::map<std::pair<std::string_view, Origin>, std::unordered_map<std::uint32_t, std::size_t>>
      streams;
  for (std::uint32_t f = 0; f < frames_.size(); ++f) {
    const TelemetryFrame& frame = frames_[f];
    auto& index = streams[{frame.spacecraft, frame.origin}];
    for (const Sample& sample : frame.samples) {
      const auto [found, is_new] = index.try_emplace(sample.parameter, series_.size());
      if (is_new)
        series_.push_back({.spacecraft = frame.spacecraft,
                           .origin = frame.origin,
                           .parameter = sample.parameter});
      series_[found->second].arrivals.push_back({&sample, f});
    }
  }
}

std::size_t Append::source_of(const TelemetryFrame& frame) {
  const StreamKey key{frame.spacecraft, frame.origin, frame.source};
  const auto [found, is_new] = source_index_.try_emplace(key, sources_.size());
  if (!is_new) return found->second;
  Source source;
  sqlite::Query row = connection_.query(
      "SELECT id, frames, samples, duplicates, conflicts, late, non_finite, out_of_order, "
      "restarts, missing, lowest_sequence, lowest_time, highest_sequence, highest_time "
      "FROM source WHERE spacecraft = ? AND origin = ? AND name = ?",
      frame.spacecraft, frame.origin, frame.source);
  SequenceTracker& tracker = source.tracker;
  if (row.step()) {
    tracker.source = row.integer(0);
    int column = 0;
    for (std::uint64_t* count :
         {&source.frames, &source.samples, &source.duplicates, &source.conflicts, &source.late,
          &source.non_finite, &tracker.out_of_order, &tracker.restarts, &tracker.missing})
      *count = row.integer<std::uint64_t>(++column);
    tracker.started = true;
    tracker.lowest = {from_column(row.integer(10)), row.integer(11)};
    tracker.highest = {from_column(row.integer(12)), row.integer(13)};
  } else {
    connection_.query("INSERT INTO source (spacecraft, origin, name) VALUES (?, ?, ?)")
        .run(frame.spacecraft, frame.origin, frame.source);
    tracker.source = connection_.last_id();
  }
  sources_.push_back(source);
  return found->second;
}

void Append::load(SeriesState& series) {
  sqlite::Query row = connection_.query(
      "SELECT id, samples, first_time, last_time FROM series "
      "WHERE spacecraft = ? AND origin = ? AND parameter = ?",
      series.spacecraft, series.origin, series.parameter);
  if (row.step()) {
    series.id = row.integer(0);
    series.samples = row.integer<std::uint64_t>(1);
    series.first = row.integer(2);
    series.last = row.integer(3);
    return;
  }
  connection_.query("INSERT INTO series (spacecraft, origin, parameter) VALUES (?, ?, ?)")
      .run(series.spacecraft, series.origin, series.parameter);
  series.id = connection_.last_id();
}

void Append::store(SeriesState& series) {
  sqlite::Query insert = connection_.query(
      "INSERT INTO sample (series, time, value, quality, source) VALUES (?, ?, ?, ?, ?) "
      "ON CONFLICT DO NOTHING");
  for (const Arrival& arrival : series.arrivals)
    if (store_one(series, arrival, insert))
      series.changed.push_back(frames_[arrival.frame].generation_time);
}

// True when the archive holds something else than before.
bool Append::store_one(SeriesState& series, const Arrival& arrival, sqlite::Query& insert) {
  const Time time = frames_[arrival.frame].generation_time;
  const double value = arrival.sample->value;
  const Quality quality = quality_of(*arrival.sample);
  Source& source = sources_[frame_source_[arrival.frame]];
  ++source.samples;
  if (!std::isfinite(value)) ++source.non_finite, ++report_.non_finite;
  if (insert.run(series.id, time, value, quality, source.tracker.source) == 0)
    return settle_collision(series, time, value, quality, source);
  frame_is_new_[arrival.frame] = true;
  ++report_.stored;
  ++series.samples;
  if (series.last && time < *series.last) ++source.late, ++report_.late;
  series.first = std::min(series.first.value_or(time), time);
  series.last = std::max(series.last.value_or(time), time);
  return true;
}

bool Append::settle_collision(const SeriesState& series, Time time, double value, Quality quality,
                              Source& source) {
  bool same = false, better = false;
  {
    sqlite::Query kept = connection_.query(
        "SELECT value, quality FROM sample WHERE series = ? AND time = ?", series.id, time);
    kept.step();
    same = kept.is_null(0) ? std::isnan(value) : same_value(kept.real(0), value);
    better = quality < kept.integer<Quality>(1);
  }
  ++(same ? source.duplicates : source.conflicts);
  ++(same ? report_.duplicates : report_.conflicts);
  if (better)
    connection_
        .query(
            "UPDATE sample SET value = ?, quality = ?, source = ? "
            "WHERE series = ? AND time = ?")
        .run(value, quality, source.tracker.source, series.id, time);
  return better;
}

void Append::save(const SeriesState& series) {
  connection_.query("UPDATE series SET samples = ?, first_time = ?, last_time = ? WHERE id = ?")
      .run(series.samples, series.first, series.last, series.id);
}

void Append::mark_late(const SeriesState& series) {
  std::vector<Time> late;
  {
    sqlite::Query seal =
        connection_.query("SELECT until FROM seal WHERE spacecraft = ?", series.spacecraft);
    if (!seal.step()) return;
    const Time until = seal.integer(0);
    std::copy_if(series.changed.begin(), series.changed.end(), std::back_inserter(late),
                 [&](Time time) { return time < until; });
  }
  std::sort(late.begin(), late.end());
  for (std::size_t i = 0; i < late.size();) {
    const Time begin = late[i];
    while (i + 1 < late.size() && are_near(late[i], late[i + 1])) ++i;
    add_late_range(series.id, {begin, just_after(late[i])});
    ++i;
  }
}

void Append::add_late_range(std::int64_t series, TimeRange range) {
  constexpr Time least = std::numeric_limits<Time>::min(), most = std::numeric_limits<Time>::max();
  const Time from =
      range.begin < least + late_merge_distance ? least : range.begin - late_merge_distance;
  const Time until =
      range.end > most - late_merge_distance ? most : range.end + late_merge_distance;
  {
    sqlite::Query near = connection_.query(
        "DELETE FROM late_range WHERE series = ? AND begin_time <= ? AND end_time >= ? "
        "RETURNING begin_time, end_time",
        series, until, from);
    while (near.step()) {
      range.begin = std::min(range.begin, near.integer(0));
      range.end = std::max(range.end, near.integer(1));
    }
  }
  connection_.query("INSERT INTO late_range (series, begin_time, end_time) VALUES (?, ?, ?)")
      .run(series, range.begin, range.end);
}

void Append::track_sequences() {
  for (std::size_t f = 0; f < frames_.size(); ++f) {
    Source& source = sources_[frame_source_[f]];
    ++source.frames;
    source.tracker.observe(connection_, {frames_[f].sequence, frames_[f].generation_time},
                           frame_is_new_[f]);
  }
}

void Append::save(const Source& source) {
  const SequenceTracker& tracker = source.tracker;
  connection_
      .query(
          "UPDATE source SET frames = ?, samples = ?, duplicates = ?, conflicts = ?, late = ?, "
          "non_finite = ?, out_of_order = ?, restarts = ?, missing = ?, lowest_sequence = ?, "
          "lowest_time = ?, highest_sequence = ?, highest_time = ? WHERE id = ?")
      .run(source.frames, source.samples, source.duplicates, source.conflicts, source.late,
           source.non_finite, tracker.out_of_order, tracker.restarts, tracker.missing,
           to_column(tracker.lowest.sequence), tracker.lowest.time,
           to_column(tracker.highest.sequence), tracker.highest.time, tracker.source);
}

}  // namespace reident::storage
