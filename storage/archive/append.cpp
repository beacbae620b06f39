#include "storage/archive/append.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <string>

#include "storage/archive/revision.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

// Room for one series in one batch: frames may be many and of many series with a sample each.
constexpr std::size_t reserved_arrivals = 4096;
constexpr std::size_t postponed_of_step = 4096;

bool same_value(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) ||
         (std::isnan(a) && std::isnan(b));
}

Quality quality_of(const Sample& sample) {
  return std::isfinite(sample.value) ? facts(sample.quality).quality : Quality::invalid;
}

/// As one value does that a decoder rounds to single precision.
bool differ_by_rounding(double a, double b) {
  constexpr double resolution = 1e-6;
  return std::abs(a - b) <= resolution * std::max(std::abs(a), std::abs(b));
}

// The distance of two times can be twice as large as a Time holds.
bool are_near(Time earlier, Time later) {
  return static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier) <=
         static_cast<std::uint64_t>(late_merge_distance);
}

}  // namespace

AppendReport Append::run() {
  report_.frames = frames_.size();
  frame_is_new_.assign(frames_.size(), 0);
  frame_source_.reserve(frames_.size());
  for (const TelemetryFrame& frame : frames_) {
    frame_source_.push_back(source_of(frame));
    if (which_ == Frames::new_ones) sources_[frame_source_.back()].samples += frame.samples.size();
  }
  sort_by_series();
  for (const SeriesArrivals& series : series_) store(series);
  if (which_ == Frames::new_ones) track_sequences();
  for (const Source& source : sources_) save(source);
  return std::move(report_);
}

// Samples of one series lie side by side in the file; their order of arrival is kept.
void Append::sort_by_series() {
  std::map<std::pair<std::string_view, Origin>, Stream> streams;
  for (std::uint32_t f = 0; f < frames_.size(); ++f) {
    const TelemetryFrame& frame = frames_[f];
    Stream& stream = streams[{frame.spacecraft, frame.origin}];
    for (std::size_t i = 0; i < frame.samples.size(); ++i) {
      const Sample& sample = frame.samples[i];
      series_[series_of(stream, frame, i)].arrivals.push_back(
          {sample.value, f, quality_of(sample)});
    }
  }
}

std::size_t Append::series_of(Stream& stream, const TelemetryFrame& frame, std::size_t position) {
  const std::uint32_t parameter = frame.samples[position].parameter;
  if (position < stream.last.size() && stream.last[position].first == parameter)
    return stream.last[position].second;
  const auto [found, is_new] = stream.index.try_emplace(parameter, series_.size());
  if (is_new) {
    series_.push_back({.first_frame = &frame, .parameter = parameter});
    series_.back().arrivals.reserve(std::min(frames_.size(), reserved_arrivals));
  }
  if (stream.last.size() <= position) stream.last.resize(position + 1);
  stream.last[position] = {parameter, found->second};
  return found->second;
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

void Append::store(const SeriesArrivals& series) {
  const TelemetryFrame& of = *series.first_frame;
  SeriesHead& head = writer_.recent().series(of.spacecraft, of.origin, series.parameter);
  const auto not_above = [this](const Arrival& a, const Arrival& b) {
    return time_of(a) >= time_of(b);
  };
  const bool is_all_new = (!head.last || time_of(series.arrivals.front()) > *head.last) &&
                          std::adjacent_find(series.arrivals.begin(), series.arrivals.end(),
                                             not_above) == series.arrivals.end();
  SampleColumns replaced;
  SampleColumns landed = is_all_new ? all_new(series) : settled(series, head, replaced);
  if (is_all_new) head.samples += landed.size();
  if (landed.empty()) return;
  if (const auto until = sealed_until(of.spacecraft); until && landed.time.front() < *until) {
    const auto end = std::lower_bound(landed.time.begin(), landed.time.end(), *until);
    const std::span<const Time> sealed(landed.time.begin(), end);
    mark_late(head.id, sealed);
    keep_what_was(head.id, sealed, replaced);
  }
  report_.touched.push_back({of.spacecraft,
                             of.origin,
                             series.parameter,
                             {landed.time.front(), just_after(landed.time.back())}});
  save(head, std::move(landed));
}

SampleColumns Append::all_new(const SeriesArrivals& series) {
  SampleColumns landed;
  landed.reserve(series.arrivals.size());
  for (const Arrival& arrival : series.arrivals) {
    Source& source = source_of(arrival);
    if (!std::isfinite(arrival.value)) ++source.non_finite, ++report_.non_finite;
    frame_is_new_[arrival.frame] = 1;
    landed.push_back(time_of(arrival), {arrival.value, arrival.quality, source.tracker.source});
  }
  report_.stored += landed.size();
  return landed;
}

SampleColumns Append::settled(const SeriesArrivals& series, SeriesHead& head,
                              SampleColumns& replaced) {
  std::vector<std::uint32_t> order(series.arrivals.size());
  std::vector<std::uint8_t> is_late(series.arrivals.size());
  std::optional<Time> newest = head.last;
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    order[i] = i;
    const Time time = time_of(series.arrivals[i]);
    is_late[i] = newest && time < *newest;
    newest = std::max(newest.value_or(time), time);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return time_of(series.arrivals[a]) < time_of(series.arrivals[b]);
  });
  SampleColumns landed;
  for (std::size_t i = 0; i < order.size();) {
    const Time time = time_of(series.arrivals[order[i]]);
    std::optional<Held> kept;
    try {
      kept = held(head, time);
    } catch (const ShardError& why) {
      for (; i < order.size() && time_of(series.arrivals[order[i]]) == time; ++i)
        postpone(head, series.arrivals[order[i]], why);
      continue;
    }
    const std::optional<Held> before = kept;
    bool changed = false;
    for (; i < order.size() && time_of(series.arrivals[order[i]]) == time; ++i) {
      const Arrival& arrival = series.arrivals[order[i]];
      Source& source = source_of(arrival);
      if (!std::isfinite(arrival.value)) ++source.non_finite, ++report_.non_finite;
      if (!kept) {
        frame_is_new_[arrival.frame] = 1;
        ++report_.stored;
        ++head.samples;
        if (is_late[order[i]]) ++source.late, ++report_.late;
      } else {
        const bool same = same_value(kept->value, arrival.value);
        ++(same ? source.duplicates : source.conflicts);
        ++(same ? report_.duplicates : report_.conflicts);
        if (contradicts(*kept, arrival)) {
          kept->quality = Quality::disputed;
          changed = true;
        }
        if (kept->quality == Quality::disputed || !is_better(arrival.quality, kept->quality))
          continue;
      }
      kept = {arrival.value, arrival.quality, source.tracker.source};
      changed = true;
    }
    if (!changed) continue;
    landed.push_back(time, *kept);
    if (before) replaced.push_back(time, *before);
  }
  return landed;
}

bool Append::contradicts(const Held& kept, const Arrival& arrival) const {
  const TelemetryFrame& frame = frames_[arrival.frame];
  return frame.origin == Origin::real && frame.numbered && kept.quality == Quality::good &&
         arrival.quality == Quality::good && !differ_by_rounding(kept.value, arrival.value);
}

std::optional<Held> Append::held(const SeriesHead& head, Time time) {
  if (!head.last || time > *head.last || time < *head.first) return std::nullopt;
  if (const auto recent = RecentTier::find(head, time)) return recent;
  return writer_.chunks().find(head.id, time);
}

// Whether its frame is new nobody knows: it fills a gap of its source, and begins no run.
void Append::postpone(const SeriesHead& head, const Arrival& arrival, const ShardError& why) {
  writer_.postponed().add(
      {.series = head.id,
       .time = time_of(arrival),
       .sample = {arrival.value, arrival.quality, source_of(arrival).tracker.source},
       .is_numbered = frames_[arrival.frame].numbered},
      why);
}

void Append::save(SeriesHead& head, SampleColumns&& landed) {
  head.first = std::min(head.first.value_or(landed.time.front()), landed.time.front());
  head.last = std::max(head.last.value_or(landed.time.back()), landed.time.back());
  connection_.query("UPDATE series SET samples = ?, first_time = ?, last_time = ? WHERE id = ?")
      .run(head.samples, head.first, head.last, head.id);
  std::int64_t batch = batch_;
  for (std::size_t first = 0; first < landed.size(); first += most_samples) {
    const std::size_t last = std::min(landed.size(), first + most_samples);
    if (first == 0 && last == landed.size()) {
      writer_.recent().add(head, batch, std::move(landed));
      return;
    }
    SampleColumns piece;
    piece.append(landed, first, last);
    writer_.recent().add(head, batch++, std::move(piece));
  }
}

std::optional<Time> Append::sealed_until(const std::string& spacecraft) {
  const auto [known, is_new] = seals_.try_emplace(spacecraft);
  if (is_new) {
    sqlite::Query seal =
        connection_.query("SELECT until FROM seal WHERE spacecraft = ?", spacecraft);
    if (seal.step()) known->second = seal.integer(0);
  }
  return known->second;
}

void Append::mark_late(std::int64_t series, std::span<const Time> changed) {
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const Time begin = changed[i];
    while (i + 1 < changed.size() && are_near(changed[i], changed[i + 1])) ++i;
    add_late_range(series, {begin, just_after(changed[i])});
  }
}

void Append::keep_what_was(std::int64_t series, std::span<const Time> changed,
                           const SampleColumns& replaced) {
  std::int64_t batch = batch_;
  for (std::size_t first = 0; first < changed.size(); first += most_samples) {
    const std::span<const Time> part =
        changed.subspan(first, std::min(most_samples, changed.size() - first));
    Revision revision;
    const auto begin = std::lower_bound(replaced.time.begin(), replaced.time.end(), part.front());
    const auto end = std::upper_bound(begin, replaced.time.end(), part.back());
    revision.replaced.append(replaced, static_cast<std::size_t>(begin - replaced.time.begin()),
                             static_cast<std::size_t>(end - replaced.time.begin()));
    std::set_difference(part.begin(), part.end(), begin, end, std::back_inserter(revision.landed));
    keep_revision(connection_, writer_.chunks().encoder(), series, batch++, revision);
  }
}

void Append::add_late_range(std::int64_t series, TimeRange range) {
  const Time from = earlier(range.begin, late_merge_distance);
  const Time until = later(range.end, late_merge_distance);
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
    const TelemetryFrame& frame = frames_[f];
    if (!frame.numbered) continue;
    const bool begins = source.tracker.observe(connection_, {frame.sequence, frame.generation_time},
                                               frame.first_sequence, frame_is_new_[f] != 0);
    if (begins && frame.sequence > std::max<std::uint64_t>(frame.first_sequence, 1))
      report_.late_starts.push_back(
          {frame.spacecraft, frame.source, frame.sequence, frame.first_sequence});
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

namespace {

/// Whether its shard cannot be read yet. Then it is put back.
bool still_waits(Writer& writer, const PostponedSample& postponed) {
  try {
    writer.chunks().find(postponed.series, postponed.time);
    return false;
  } catch (const ShardError& why) {
    writer.postponed().add(postponed, why);
    return true;
  }
}

/// A frame of one sample; none where its source was removed meanwhile.
std::optional<TelemetryFrame> frame_of(sqlite::Connection& connection,
                                       const PostponedSample& postponed) {
  sqlite::Query row = connection.query(
      "SELECT source.spacecraft, name, source.origin, parameter FROM source, series "
      "WHERE source.id = ? AND series.id = ?",
      postponed.sample.source, postponed.series);
  if (!row.step()) return std::nullopt;
  return TelemetryFrame{.spacecraft = row.text(0),
                        .source = row.text(1),
                        .origin = row.integer<Origin>(2),
                        .generation_time = postponed.time,
                        .samples = {{row.integer<std::uint32_t>(3), postponed.sample.quality,
                                     postponed.sample.value}},
                        .numbered = postponed.is_numbered};
}

}  // namespace

bool append_postponed(sqlite::Connection& connection, Writer& writer,
                      std::vector<AppendReport::Touched>& touched) {
  if (!writer.postponed().is_due()) return false;
  writer.postponed().take(postponed_of_step, [&](std::vector<PostponedSample>&& postponed) {
    std::map<std::int64_t, std::map<Time, Held>> settled;
    std::vector<TelemetryFrame> frames;
    for (const PostponedSample& one : postponed) {
      if (still_waits(writer, one)) continue;
      if (one.is_settled)
        settled[one.series][one.time] = one.sample;
      else if (auto frame = frame_of(connection, one))
        frames.push_back(*std::move(frame));
    }
    const std::int64_t batch = writer.recent().next_batch();
    for (const auto& [series, samples] : settled) {
      SampleColumns columns;
      for (const auto& [time, sample] : samples) columns.push_back(time, sample);
      writer.recent().add(writer.recent().series(series), batch, std::move(columns));
    }
    for (auto& range : Append(connection, writer, frames, Append::Frames::postponed).run().touched)
      touched.push_back(std::move(range));
  });
  return writer.postponed().is_due();
}

}  // namespace reident::storage
