#include "storage/care/completeness.hpp"

#include <algorithm>
#include <cmath>

#include "storage/archive/archive_access.hpp"
#include "storage/archive/damage.hpp"
#include "storage/chunks/sample_gaps.hpp"
#include "storage/database/connection.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

constexpr std::size_t measured_at_once = 16384;  // samples of one sampling, as in a chunk

double distance(Time from, Time to) {
  return static_cast<double>(to) - static_cast<double>(from);
}

/// A range of a series between whose ends there are no samples but its own.
struct Piece {
  Time first = 0;
  Time last = 0;
  std::optional<ChunkPlace> place{};  // of the one chunk that it is; none with recent samples
  std::size_t samples = 0;
  Sampling sampling{};
};

class Counter {
 public:
  Counter(const Database& database, const SeriesInfo& series, const TimeBins& bins)
      : impl_(database.impl()),
        access_(archive_access(database)),
        bytes_(*impl_.connection),
        series_(series),
        bins_(bins),
        counts_(bins.count()) {}

  std::vector<BinCounts> run(Time until);
  /// The gaps that run() met.
  std::vector<TimeRange> take_gaps() && { return std::move(gaps_); }

 private:
  /// Chunks that meet the bins, with one on either side, and what is recent over or between them.
  std::vector<Piece> pieces();

  void count_chunk(const Piece& chunk);

  std::vector<Time> times_of(const Piece& chunk);

  void count_decoded(const Piece& piece);

  void count_times(const std::vector<Time>& times);

  /// The gap, if it is one, between the last sample so far and the next one.
  void add_border(Time next, const Sampling& sampling) {
    if (!last_ || next <= *last_) return;
    if (const auto gap = gap_between(*last_, sampling_, next, sampling))
      add_gap(*gap, std::max(sampling_.step, sampling.step));
  }

  void add_gap(const SampleGap& gap, Time step);

  Database::Impl& impl_;
  ArchiveAccess& access_;
  ChunkBytes bytes_;
  const SeriesInfo& series_;
  const TimeBins& bins_;
  std::vector<BinCounts> counts_;
  std::vector<TimeRange> gaps_;
  ChunkDecoder decoder_;
  SamplingMeter meter_;
  std::optional<Time> last_;  // the last sample so far, and how those before it are sampled
  Sampling sampling_;
};

std::vector<BinCounts> Counter::run(Time until) {
  const sqlite::ReadTransaction snapshot(*impl_.connection);
  for (const Piece& piece : pieces()) {
    if (piece.place)
      count_chunk(piece);
    else
      count_decoded(piece);
  }
  add_border(until, {});
  return std::move(counts_);
}

std::vector<Piece> Counter::pieces() {
  std::vector<Piece> found;
  for (const SeriesReader::Extent& recent : access_.reader().recent(series_.id))
    found.push_back({.first = recent.first, .last = recent.last});
  sqlite::Query row = impl_.connection->query(
      "SELECT first_time, last_time, shard, data, samples, step, gap_limit FROM chunk "
      "WHERE series = ?1 "
      "AND first_time >= coalesce((SELECT max(first_time) FROM chunk WHERE series = ?1 AND "
      "last_time < ?2 AND first_time < ?2), ?4) AND first_time <= coalesce((SELECT "
      "min(first_time) FROM chunk WHERE series = ?1 AND first_time >= ?3), ?3)",
      series_.id, bins_.range().begin, bins_.range().end, earliest_time);
  while (row.step())
    found.push_back({row.integer(0),
                     row.integer(1),
                     ChunkPlace{row.integer(2), row.integer(3)},
                     row.integer<std::size_t>(4),
                     {row.integer(5), row.integer(6)}});
  std::sort(found.begin(), found.end(),
            [](const Piece& a, const Piece& b) { return a.first < b.first; });
  std::vector<Piece> joined;
  for (const Piece& piece : found) {
    if (joined.empty() || piece.first > joined.back().last) {
      joined.push_back(piece);
    } else {
      joined.back().last = std::max(joined.back().last, piece.last);
      joined.back().place.reset();
    }
  }
  return joined;
}

void Counter::count_chunk(const Piece& chunk) {
  add_border(chunk.first, chunk.sampling);
  last_ = chunk.last;
  sampling_ = chunk.sampling;
  const TimeRange range = bins_.range();
  if (chunk.last < range.begin || chunk.first >= range.end) return;
  if (chunk.first >= range.begin && chunk.last < range.end &&
      bins_.of(chunk.first) == bins_.of(chunk.last))
    counts_[bins_.of(chunk.first)].came += chunk.samples;
  else
    count_times(times_of(chunk));
  sqlite::Query gap = impl_.connection->query(
      "SELECT begin_time, end_time FROM sample_gap WHERE series = ? AND begin_time >= ? "
      "AND begin_time < ?",
      series_.id, chunk.first, chunk.last);
  while (gap.step()) add_gap({gap.integer(0), gap.integer(1)}, chunk.sampling.step);
}

std::vector<Time> Counter::times_of(const Piece& chunk) {
  std::vector<Time> times;
  if (const auto error = decoder_.decode(bytes_.read(*chunk.place), {.time = &times}))
    throw damage(*impl_.connection,
                 {series_.id, chunk.first, chunk.last, chunk.samples, chunk.place->shard}, *error);
  return times;
}

void Counter::count_decoded(const Piece& piece) {
  const TimeRange range{piece.first, just_after(piece.last)};
  const std::vector<Time> times =
      access_.reader().read(series_.id, range, {false, false, false}).time;
  count_times(times);
  std::vector<SampleGap> gaps;
  for (std::size_t begin = 0; begin < times.size(); begin += measured_at_once) {
    const auto part =
        std::span(times).subspan(begin, std::min(measured_at_once, times.size() - begin));
    const Sampling sampling = meter_.measure(part);
    add_border(part.front(), sampling);
    gaps.clear();
    append_gaps(part, sampling, gaps);
    for (const SampleGap& gap : gaps) add_gap(gap, sampling.step);
    last_ = part.back();
    sampling_ = sampling;
  }
}

void Counter::count_times(const std::vector<Time>& times) {
  const TimeRange range = bins_.range();
  auto at = std::lower_bound(times.begin(), times.end(), range.begin);
  while (at != times.end() && *at < range.end) {
    const std::size_t bin = bins_.of(*at);
    const auto end = std::lower_bound(at, times.end(), bins_.at(bin).end);
    counts_[bin].came += static_cast<std::uint64_t>(end - at);
    at = end;
  }
}

void Counter::add_gap(const SampleGap& gap, Time step) {
  const TimeRange range = bins_.range();
  if (gap.end <= range.begin || gap.begin >= range.end || step <= 0) return;
  gaps_.push_back({gap.begin, gap.end});
  if (gap.begin >= range.begin) {
    BinCounts& counts = counts_[bins_.of(gap.begin)];
    ++counts.gaps;
    // The distance of two times can be twice as large as a Time holds.
    const auto between =
        static_cast<std::uint64_t>(gap.end) - static_cast<std::uint64_t>(gap.begin);
    counts.longest_gap = std::max(counts.longest_gap,
                                  static_cast<Time>(std::min<std::uint64_t>(between, latest_time)));
  }
  const double length = distance(gap.begin, gap.end);
  const double missing = std::max(1.0, std::round(length / static_cast<double>(step)) - 1);
  // Those missing stand at begin + k apart, 1 <= k <= missing.
  const double apart = length / (missing + 1);
  const auto before = [&](Time time) {
    const double k = std::ceil(distance(gap.begin, time) / apart) - 1;
    return static_cast<std::uint64_t>(std::clamp(k, 0.0, missing));
  };
  const std::size_t last = bins_.of(std::min(gap.end, range.end - 1));
  for (std::size_t bin = bins_.of(std::max(gap.begin, range.begin)); bin <= last; ++bin)
    counts_[bin].missing += before(bins_.at(bin).end) - before(bins_.at(bin).begin);
}

}  // namespace

std::vector<BinCounts> completeness(const Database& database, const SeriesInfo& series,
                                    const TimeBins& bins, Time until) {
  return Counter(database, series, bins).run(until);
}

std::vector<TimeRange> gaps(const Database& database, const SeriesInfo& series, TimeRange range,
                            Time until) {
  const TimeBins whole(range, range.end - range.begin);
  Counter counter(database, series, whole);
  counter.run(until);
  return std::move(counter).take_gaps();
}

}  // namespace reident::storage
