#include "storage/archive/archive.hpp"

#include <cassert>
#include <utility>

#include "storage/archive/append.hpp"
#include "storage/archive/archive_access.hpp"
#include "storage/database/connection.hpp"
#include "storage/types/time_ends.hpp"

namespace reident::storage {
namespace {

std::optional<double> optional_real(const sqlite::Query& row, int column) {
  return row.is_null(column) ? std::nullopt : std::optional(row.real(column));
}

constexpr std::string_view descriptor_columns =
    "spacecraft, id, name, unit, description, kind = 'digital', low_limit, high_limit";

ParameterDescriptor descriptor(const sqlite::Query& row) {
  return {.spacecraft = row.text(0),
          .id = row.integer<std::uint32_t>(1),
          .name = row.text(2),
          .unit = row.text(3),
          .description = row.text(4),
          .kind = row.integer<ParameterKind>(5),
          .low_limit = optional_real(row, 6),
          .high_limit = optional_real(row, 7)};
}

}  // namespace

Archive::Archive(Database& database, const ArchiveOptions& options)
    : database_(database), options_(options) {
  assert(options.chunk_samples >= 16 && options.chunk_samples <= 65536);
}

AppendReport Archive::append(std::span<const TelemetryFrame> frames) {
  sqlite::Transaction transaction(connection(database_));
  return archive_access(database_).write(options_, [&](Writer& writer) {
    AppendReport report = Append(connection(database_), writer, frames).run();
    append_postponed(connection(database_), writer, report.touched);
    writer.compact_some(report.stored);
    report.damages = writer.take_damages();
    report.postponed = writer.postponed().reason();
    transaction.commit();
    return report;
  });
}

void Archive::compact() {
  for (bool begins = true, more = true; more; begins = false) {
    sqlite::Transaction transaction(connection(database_));
    more = archive_access(database_).write(options_, [&](Writer& writer) {
      if (begins) writer.postponed().try_again();
      std::vector<AppendReport::Touched> touched;
      const bool is_due = append_postponed(connection(database_), writer, touched);
      const bool is_more = writer.compact_all_step() || is_due;
      transaction.commit();
      return is_more;
    });
  }
}

void Archive::describe(std::span<const ParameterDescriptor> descriptors) {
  sqlite::Transaction transaction(connection(database_));
  {
    sqlite::Query replace = connection(database_).query(
        "INSERT OR REPLACE INTO parameter (spacecraft, id, name, unit, description, kind, "
        "low_limit, high_limit) VALUES (?, ?, ?, ?, ?, ?, ?, ?)");
    for (const ParameterDescriptor& d : descriptors)
      replace.run(d.spacecraft, d.id, d.name, d.unit, d.description, name(d.kind), d.low_limit,
                  d.high_limit);
  }
  transaction.commit();
}

void Archive::seal(const std::string& spacecraft, Time end) {
  connection(database_)
      .query(
          "INSERT INTO seal (spacecraft, until) VALUES (?, ?) "
          "ON CONFLICT DO UPDATE SET until = excluded.until WHERE excluded.until > until")
      .run(spacecraft, end);
}

std::vector<LateRange> Archive::late_ranges(const std::string& spacecraft) const {
  std::vector<LateRange> ranges;
  sqlite::Query row = connection(database_).query(
      "SELECT late_range.id, origin, parameter, begin_time, end_time FROM late_range "
      "JOIN series ON series.id = late_range.series WHERE spacecraft = ? ORDER BY late_range.id",
      spacecraft);
  while (row.step())
    ranges.push_back({.id = row.integer(0),
                      .spacecraft = spacecraft,
                      .origin = row.integer<Origin>(1),
                      .parameter = row.integer<std::uint32_t>(2),
                      .range = {row.integer(3), row.integer(4)}});
  return ranges;
}

void Archive::forget_late(std::span<const LateRange> ranges) {
  sqlite::Transaction transaction(connection(database_));
  {
    sqlite::Query remove = connection(database_).query("DELETE FROM late_range WHERE id = ?");
    for (const LateRange& range : ranges) remove.run(range.id);
  }
  transaction.commit();
}

std::vector<std::string> Archive::spacecraft() const {
  std::vector<std::string> names;
  sqlite::Query row = connection(database_).query(
      "SELECT spacecraft FROM series UNION SELECT spacecraft FROM parameter ORDER BY 1");
  while (row.step()) names.push_back(row.text(0));
  return names;
}

std::vector<ParameterDescriptor> Archive::parameters(const std::string& spacecraft) const {
  std::vector<ParameterDescriptor> descriptors;
  sqlite::Query row =
      connection(database_).query("SELECT " + std::string(descriptor_columns) +
                                      " FROM parameter WHERE spacecraft = ? ORDER BY id",
                                  spacecraft);
  while (row.step()) descriptors.push_back(descriptor(row));
  return descriptors;
}

std::optional<ParameterDescriptor> Archive::parameter(const std::string& spacecraft,
                                                      const std::string& name) const {
  sqlite::Query row = connection(database_).query(
      "SELECT " + std::string(descriptor_columns) +
          " FROM parameter WHERE spacecraft = ? AND name = ? ORDER BY id LIMIT 1",
      spacecraft, name);
  return row.step() ? std::optional(descriptor(row)) : std::nullopt;
}

Series Archive::read(const std::string& spacecraft, Origin origin, std::uint32_t parameter,
                     TimeRange range) const {
  return read(spacecraft, origin, parameter, range, false);
}

Series Archive::read_with_sources(const std::string& spacecraft, Origin origin,
                                  std::uint32_t parameter, TimeRange range) const {
  return read(spacecraft, origin, parameter, range, true);
}

Series Archive::read(const std::string& spacecraft, Origin origin, std::uint32_t parameter,
                     TimeRange range, bool with_sources) const {
  SeriesReader& reader = archive_access(database_).reader();
  const auto series = reader.find(spacecraft, origin, parameter);
  if (!series) return {};
  SampleColumns samples = reader.read(*series, range, {.source = with_sources}, as_of_);
  return {std::move(samples.time), std::move(samples.value), std::move(samples.quality),
          std::move(samples.source)};
}

std::vector<std::int64_t> Archive::revisions(const std::string& spacecraft, Origin origin,
                                             std::uint32_t parameter, TimeRange range) const {
  std::vector<std::int64_t> batches;
  sqlite::Query row = connection(database_).query(
      "SELECT batch FROM revision WHERE series = (SELECT id FROM series WHERE spacecraft = ? AND "
      "origin = ? AND parameter = ?) AND first_time < ? AND last_time >= ? ORDER BY batch DESC",
      spacecraft, origin, parameter, range.end, range.begin);
  while (row.step()) batches.push_back(row.integer(0));
  return batches;
}

Archive Archive::before(std::int64_t batch) const {
  Archive earlier = *this;
  earlier.as_of_ = batch - 1;
  return earlier;
}

std::optional<Time> Archive::first_at_or_after(const std::string& spacecraft, Origin origin,
                                               std::uint32_t parameter, Time time) const {
  SeriesReader& reader = archive_access(database_).reader();
  const auto series = reader.find(spacecraft, origin, parameter);
  return series ? reader.first_at_or_after(*series, time) : std::nullopt;
}

std::optional<Time> Archive::last_at_or_before(const std::string& spacecraft, Origin origin,
                                               std::uint32_t parameter, Time time) const {
  SeriesReader& reader = archive_access(database_).reader();
  const auto series = reader.find(spacecraft, origin, parameter);
  return series ? reader.last_at_or_before(*series, time) : std::nullopt;
}

std::optional<TimeRange> Archive::extent(const std::string& spacecraft, Origin origin) const {
  sqlite::Query row = connection(database_).query(
      "SELECT min(first_time), max(last_time) FROM series WHERE spacecraft = ? AND origin = ?",
      spacecraft, origin);
  if (!row.step() || row.is_null(0)) return std::nullopt;
  return TimeRange{row.integer(0), just_after(row.integer(1))};
}

std::uint64_t Archive::sample_count() const {
  sqlite::Query row = connection(database_).query("SELECT coalesce(sum(samples), 0) FROM series");
  row.step();
  return row.integer<std::uint64_t>(0);
}

std::vector<SourceCounts> Archive::sources() const {
  std::vector<SourceCounts> sources;
  sqlite::Query row = connection(database_).query(
      "SELECT spacecraft, name, origin, frames, samples, duplicates, conflicts, late, non_finite, "
      "out_of_order, restarts, missing, highest_sequence FROM source "
      "ORDER BY spacecraft, name, origin");
  while (row.step())
    sources.push_back({.spacecraft = row.text(0),
                       .source = row.text(1),
                       .origin = row.integer<Origin>(2),
                       .frames = row.integer<std::uint64_t>(3),
                       .samples = row.integer<std::uint64_t>(4),
                       .duplicates = row.integer<std::uint64_t>(5),
                       .conflicts = row.integer<std::uint64_t>(6),
                       .late = row.integer<std::uint64_t>(7),
                       .non_finite = row.integer<std::uint64_t>(8),
                       .out_of_order = row.integer<std::uint64_t>(9),
                       .restarts = row.integer<std::uint64_t>(10),
                       .missing = row.integer<std::uint64_t>(11),
                       .last_sequence = from_column(row.integer(12))});
  return sources;
}

std::vector<SequenceGap> Archive::sequence_gaps() const {
  std::vector<SequenceGap> gaps;
  sqlite::Query row = connection(database_).query(
      "SELECT spacecraft, name, origin, first, last, time_before, time_after FROM sequence_gap "
      "JOIN source ON source.id = sequence_gap.source ORDER BY spacecraft, name, origin, run, "
      "first");
  while (row.step())
    gaps.push_back({.spacecraft = row.text(0),
                    .source = row.text(1),
                    .origin = row.integer<Origin>(2),
                    .first = from_column(row.integer(3)),
                    .last = from_column(row.integer(4)),
                    .before = row.integer(5),
                    .after = row.integer(6)});
  return gaps;
}

}  // namespace reident::storage
