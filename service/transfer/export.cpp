#include "service/transfer/export.hpp"

#include <algorithm>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/transfer/telemetry_csv.hpp"

namespace reident::transfer {
namespace {

using csv::Error;
using storage::SampleColumns;
using storage::SeriesInfo;
using storage::Time;

constexpr std::size_t text_block = std::size_t{256} << 10;
constexpr std::size_t chunks_at_once = 8;  // some 4 MiB of samples

bool is_wanted(const SeriesInfo& series, const ExportOptions& options) {
  const auto& names = options.parameters;
  return (!options.spacecraft || series.spacecraft == *options.spacecraft) &&
         (!options.origin || series.origin == *options.origin) &&
         (names.empty() || std::find(names.begin(), names.end(), series.name) != names.end());
}

std::string known_names(const std::vector<SeriesInfo>& all,
                        const std::function<std::string(const SeriesInfo&)>& name) {
  constexpr std::size_t most = 20;
  std::vector<std::string> names;
  for (const SeriesInfo& one : all) names.push_back(name(one));
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  const std::size_t count = names.size();
  if (count > most) names.resize(most);
  return joined(names) + (count > most ? fmt::format(" and {} more", count - most) : "");
}

std::optional<Error> check_names(const std::vector<SeriesInfo>& all, const ExportOptions& options) {
  const auto has = [&](const auto& matches) {
    return std::any_of(all.begin(), all.end(), matches);
  };
  if (all.empty()) return Error{"there is no telemetry in the archive"};
  if (options.spacecraft &&
      !has([&](const SeriesInfo& one) { return one.spacecraft == *options.spacecraft; }))
    return Error{fmt::format("the archive has no spacecraft '{}'; it has {}", *options.spacecraft,
                             known_names(all, [](const auto& one) { return one.spacecraft; }))};
  for (const std::string& name : options.parameters)
    if (!has([&](const SeriesInfo& one) { return one.name == name; }))
      return Error{fmt::format("the archive has no parameter '{}'; it has {}", name,
                               known_names(all, [](const auto& one) { return one.name; }))};
  return std::nullopt;
}

/// A wide row has one place for each parameter. The series are in the order of all_series().
std::optional<Error> check_wide(const std::vector<SeriesInfo>& series) {
  const SeriesInfo& first = series.front();
  if (series.back().spacecraft != first.spacecraft)
    return Error{fmt::format("--wide takes one spacecraft; name {} or {} with --spacecraft",
                             first.spacecraft, series.back().spacecraft)};
  for (const SeriesInfo& one : series) {
    if (one.origin != first.origin)
      return Error{
          fmt::format("--wide takes one origin, and {} has both; say --origin real or "
                      "--origin simulated",
                      one.spacecraft)};
    if (&one != &first && one.name == (&one - 1)->name)
      return Error{
          fmt::format("--wide takes one parameter of a name, and two are called '{}'; "
                      "leave it out with --parameter or export without --wide",
                      one.name)};
  }
  return std::nullopt;
}

/// Rows on their way to the sink, in large pieces.
class Text {
 public:
  explicit Text(const TextSink& sink) : sink_(sink) { text_.reserve(text_block + 4096); }
  std::string& line() { return text_; }
  void end_line() {
    text_ += '\n';
    if (text_.size() >= text_block) flush();
  }
  void flush() {
    sink_(text_);
    text_.clear();
  }

 private:
  const TextSink& sink_;
  std::string text_;
};

class Export {
 public:
  Export(const history::TelemetryReader& telemetry, const std::vector<SeriesInfo>& series,
         const ExportOptions& options, const TextSink& sink, const ExportObserver& observer);

  ExportReport run() {
    report_.complete = options_.wide ? write_wide() : write_long();
    text_.flush();
    return report_;
  }

 private:
  bool go_on() const {
    const double of = static_cast<double>(std::max<std::uint64_t>(expected_, 1));
    return observer_({static_cast<double>(report_.samples) / of, report_.samples});
  }

  bool write_long();

  void write_samples(const SeriesInfo& series, const std::string& unit, const SampleColumns& batch);

  const std::string& name_of_source(std::int64_t id) {
    // Not known: its first sample came after the last look.
    if (sources_.find(id) == sources_.end()) sources_ = telemetry_.source_names();
    return sources_[id];
  }

  /// A series on its way into the columns of a wide file.
  struct Column {
    std::unique_ptr<history::SampleBatches> reader;
    SampleColumns batch;
    std::size_t at = 0;
    bool at_end = false;

    void refill() {
      at = 0;
      at_end = !reader->next(batch);
    }
    void advance() {
      if (++at == batch.size()) refill();
    }
    Time time() const { return batch.time[at]; }
  };

  bool write_wide();

  static std::optional<Time> earliest(const std::vector<Column>& columns);

  void write_row(std::vector<Column>& columns, Time time);

  const history::TelemetryReader& telemetry_;
  const std::vector<SeriesInfo>& series_;
  const ExportOptions& options_;
  Text text_;
  const ExportObserver& observer_;
  std::map<std::int64_t, std::string> sources_;
  std::uint64_t expected_ = 0;
  ExportReport report_;
};

Export::Export(const history::TelemetryReader& telemetry, const std::vector<SeriesInfo>& series,
               const ExportOptions& options, const TextSink& sink, const ExportObserver& observer)
    : telemetry_(telemetry), series_(series), options_(options), text_(sink), observer_(observer) {
  for (const SeriesInfo& one : series) expected_ += one.samples;
  report_.series = series.size();
}

bool Export::write_long() {
  std::string& line = text_.line();
  for (const std::string_view column : long_columns)
    line.append(line.empty() ? "" : ",").append(column);
  text_.end_line();
  SampleColumns batch;
  for (const SeriesInfo& series : series_) {
    const auto descriptor = telemetry_.parameter(series.spacecraft, series.name);
    std::string unit;
    append_text(unit, descriptor ? descriptor->unit : "");
    const auto reader = telemetry_.batches(series, options_.range, chunks_at_once, {});
    while (reader->next(batch)) {
      write_samples(series, unit, batch);
      if (!go_on()) return false;
    }
  }
  return true;
}

void Export::write_samples(const SeriesInfo& series, const std::string& unit,
                           const SampleColumns& batch) {
  std::string before;
  append_text(before, series.spacecraft);
  append_text(before += ',', series.name);
  before.append(",").append(storage::name(series.origin)).append(",");
  std::int64_t source = 0;
  std::string source_text;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (i == 0 || batch.source[i] != source) {
      source = batch.source[i];
      append_text(source_text = before, name_of_source(source));
      source_text += ',';
    }
    std::string& line = text_.line();
    line += source_text;
    append_time(line, batch.time[i]);
    line += ',';
    append_value(line, batch.value[i]);
    line.append(",").append(storage::name(batch.quality[i])).append(",").append(unit);
    text_.end_line();
  }
  report_.samples += batch.size();
  report_.rows += batch.size();
}

bool Export::write_wide() {
  std::string& line = text_.line();
  line += "time";
  for (const SeriesInfo& series : series_) append_text(line += ',', series.name);
  text_.end_line();
  std::vector<Column> columns;
  const std::size_t chunks = std::max<std::size_t>(1, chunks_at_once / series_.size());
  for (const SeriesInfo& series : series_)
    columns.push_back(
        {telemetry_.batches(series, options_.range, chunks, {.quality = false, .source = false}),
         {},
         0,
         false});
  for (Column& column : columns) column.refill();
  while (const auto time = earliest(columns)) {
    write_row(columns, *time);
    constexpr std::uint64_t rows_between_looks = 4096;
    if (report_.rows % rows_between_looks == 0 && !go_on()) return false;
  }
  return true;
}

std::optional<Time> Export::earliest(const std::vector<Column>& columns) {
  std::optional<Time> time;
  for (const Column& column : columns)
    if (!column.at_end && (!time || column.time() < *time)) time = column.time();
  return time;
}

void Export::write_row(std::vector<Column>& columns, Time time) {
  append_time(text_.line(), time);
  for (Column& column : columns) {
    text_.line() += ',';
    if (column.at_end || column.time() != time) continue;
    append_value(text_.line(), column.batch.value[column.at]);
    column.advance();
    ++report_.samples;
  }
  text_.end_line();
  ++report_.rows;
}

}  // namespace

std::variant<std::vector<SeriesInfo>, Error> series_to_export(
    const history::TelemetryReader& telemetry, const ExportOptions& options) {
  const std::vector<SeriesInfo> all = telemetry.series();
  if (auto error = check_names(all, options)) return *std::move(error);
  std::vector<SeriesInfo> wanted;
  std::copy_if(all.begin(), all.end(), std::back_inserter(wanted),
               [&](const SeriesInfo& one) { return is_wanted(one, options); });
  if (wanted.empty()) return Error{"the archive has no telemetry of this spacecraft and origin"};
  if (options.wide) {
    if (auto error = check_wide(wanted)) return *std::move(error);
    // In the order asked for.
    const auto& names = options.parameters;
    std::stable_sort(wanted.begin(), wanted.end(), [&](const auto& a, const auto& b) {
      return std::find(names.begin(), names.end(), a.name) <
             std::find(names.begin(), names.end(), b.name);
    });
  }
  return wanted;
}

ExportReport export_series(const history::TelemetryReader& telemetry,
                           const std::vector<SeriesInfo>& series, const ExportOptions& options,
                           const TextSink& sink, const ExportObserver& observer) {
  return Export(telemetry, series, options, sink, observer).run();
}

}  // namespace reident::transfer
