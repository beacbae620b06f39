#include "service/telemetry_file/telemetry_file.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/date_text.hpp"
#include "service/telemetry_file/head_checks.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::size_t head_bytes = std::size_t{1} << 20;
constexpr std::size_t head_rows = 20'000;
constexpr std::int64_t earliest_ns = 631'152'000'000'000'000;  // 1990
}  // namespace

struct TelemetryFile::Impl {
  Impl(TextSource source, ReadingOptions chosen)
      : options(std::move(chosen)), rows(std::move(source)) {}

  ReadingOptions options;
  RowReader rows;
  Dialect dialect;
  std::optional<MadeOf> made_of;
  std::size_t rows_read = 0;
  NumberStyle style;
  std::vector<CellFormat> formats;
  // The head, kept for finding the time.
  std::string head_text;  // its cells, one after the other
  std::vector<std::vector<std::string_view>> head_columns;
  std::vector<std::uint64_t> head_lines;
  std::optional<Clock> clock;
  std::optional<Clock> clock_at_start;  // before any row
  std::optional<ClockWatch> watch;
  std::optional<ClockStep> step;
  std::int64_t ahead_ns = 0;  // of a clock that goes on where it left off
  std::int64_t time_ns = 0;
  Error error;
  Damage damage = Damage::none;

  std::optional<Error> start();
  /// The line of the file that a cell of a row comes from; `own` is that of the row in the text.
  std::uint64_t line_of(std::size_t row, std::size_t column, std::uint64_t own) const;
  std::uint64_t line_of(std::size_t row, std::uint64_t own) const;
  std::optional<Error> find_cells();
  Step fail(Damage what, Error why) {
    damage = what;
    error = std::move(why);
    return Step::error;
  }
  std::vector<std::string> other_readings() const;
  bool is_another_header() const;
  Step fail_at_header();
  void start_watch();
  void follow(std::int64_t clock_ns);
  Step read_time();
};

std::optional<Error> TelemetryFile::Impl::start() {
  const auto head = rows.head(head_bytes);
  if (const auto* failed = std::get_if<Error>(&head)) return *failed;
  auto found = find_dialect(std::get<RowReader::Head>(head), options.dialect, rows.source().name());
  if (auto* failed = std::get_if<Error>(&found)) return std::move(*failed);
  dialect = std::get<Dialect>(std::move(found));
  // The head is looked at in a reader of its own, so that the file is not read twice.
  std::string text(std::get<RowReader::Head>(head).text);
  if (!std::get<RowReader::Head>(head).is_all)
    text.resize(std::min(text.rfind(dialect.layout.line_end), text.size() - 1) + 1);
  head_text.reserve(text.size());  // cells are no longer than what they are read from
  RowReader looked(TextSource::of_text(std::move(text), rows.source().name()));
  if (auto failed = looked.head(head_bytes); std::holds_alternative<Error>(failed))
    return std::get<Error>(failed);
  if (auto failed = looked.start(dialect.layout, dialect.first_position, dialect.first_line))
    return failed;
  head_columns.resize(dialect.columns.size());
  for (Step at = looked.next(); at != Step::end && head_lines.size() < head_rows;
       at = looked.next()) {
    if (at == Step::error && looked.damage() == Damage::none) break;
    if (at == Step::error) continue;
    head_lines.push_back(looked.line());
    for (std::size_t c = 0; c < head_columns.size(); ++c) {
      const std::size_t from = head_text.size();
      head_text += looked.cells()[c];
      head_columns[c].emplace_back(head_text.data() + from, head_text.size() - from);
    }
  }
  if (auto failed = find_cells()) return failed;
  return rows.start(dialect.layout, dialect.first_position, dialect.first_line);
}

std::optional<Error> TelemetryFile::Impl::find_cells() {
  if (options.cells.style) {
    style = *options.cells.style;
  } else {
    auto found = find_style(head_columns, dialect.layout.separator);
    if (const auto* problem = std::get_if<std::string>(&found))
      return Error{rows.source().name() + ": " + *problem};
    style = std::get<NumberStyle>(found);
  }
  for (std::size_t c = 0; c < head_columns.size(); ++c)
    formats.push_back(find_format(head_columns[c], dialect.columns[c], style, options.cells));
  return std::nullopt;
}

std::uint64_t TelemetryFile::Impl::line_of(std::size_t row, std::size_t column,
                                           std::uint64_t own) const {
  if (!made_of) return own;
  const auto& lines = made_of->lines[row];
  return column < lines.size() && lines[column] != 0 ? lines[column] : line_of(row, own);
}

std::uint64_t TelemetryFile::Impl::line_of(std::size_t row, std::uint64_t own) const {
  if (!made_of) return own;
  const auto& lines = made_of->lines[row];
  return *std::find_if(lines.begin(), lines.end(), [](std::uint64_t line) { return line != 0; });
}

TelemetryFile::TelemetryFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TelemetryFile::~TelemetryFile() = default;
TelemetryFile::TelemetryFile(TelemetryFile&&) noexcept = default;
TelemetryFile& TelemetryFile::operator=(TelemetryFile&&) noexcept = default;

std::variant<TelemetryFile, Error> TelemetryFile::start(TextSource source,
                                                        const ReadingOptions& options) {
  auto impl = std::make_unique<Impl>(std::move(source), options);
  if (auto error = impl->start()) return *std::move(error);
  return TelemetryFile(std::move(impl));
}

std::variant<TelemetryFile, Error> TelemetryFile::open(const std::filesystem::path& path,
                                                       const ReadingOptions& options) {
  auto source = TextSource::open(path, options.encoding);
  if (auto* error = std::get_if<Error>(&source)) return std::move(*error);
  return start(std::get<TextSource>(std::move(source)), options);
}

std::variant<TelemetryFile, Error> TelemetryFile::of_text(std::string text, std::string name,
                                                          const ReadingOptions& options,
                                                          std::optional<MadeOf> made_of) {
  auto opened = start(TextSource::of_text(std::move(text), std::move(name)), options);
  if (auto* file = std::get_if<TelemetryFile>(&opened)) file->impl_->made_of = std::move(made_of);
  return opened;
}

const std::vector<std::string>& TelemetryFile::columns() const {
  return impl_->dialect.columns;
}
const CellFormat& TelemetryFile::format(std::size_t column) const {
  return impl_->formats[column];
}

std::string TelemetryFile::unit(std::size_t column) const {
  if (!impl_->dialect.units.empty() && !impl_->dialect.units[column].empty())
    return impl_->dialect.units[column];
  return impl_->formats[column].unit;
}

std::variant<std::size_t, Error> TelemetryFile::find(std::string_view column) const {
  const auto& names = columns();
  const auto found = std::find(names.begin(), names.end(), column);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  return Error{impl_->rows.source().name() + ": there is no column '" + std::string(column) +
               "'; the columns are: " + joined(names)};
}

bool TelemetryFile::has_rows() const {
  return !impl_->head_lines.empty();
}

std::string TelemetryFile::first_word(std::size_t column) const {
  const auto& cells = impl_->head_columns[column];
  const StateMap* const given = given_states(impl_->options.cells, columns()[column]);
  for (std::size_t row = 0; row < cells.size(); ++row)
    if (!trimmed(cells[row]).empty() && !(given && has_state(*given, trimmed(cells[row]))))
      return fmt::format("{} in line {}", shown(cells[row]),
                         impl_->line_of(row, column, impl_->head_lines[row]));
  return "no cell";
}

std::optional<Error> TelemetryFile::find_time(bool is_series_after_series, bool of_one_spacecraft) {
  Impl& at = *impl_;
  if (is_series_after_series) {
    at.options.clock_may_go_back = true;
    at.options.continues_clock = false;
  }
  const auto refuse = [&](const Clock::Problem& problem) {
    const std::string line = problem.line == 0 ? "" : ":" + std::to_string(problem.line);
    return Error{at.rows.source().name() + line + ": " + problem.text};
  };
  std::vector<std::uint64_t> lines = at.head_lines;
  for (std::size_t row = 0; row < lines.size(); ++row) lines[row] = at.line_of(row, lines[row]);
  const HeadCells head{at.dialect.columns, at.dialect.units, at.head_columns, lines,
                       at.style,           at.dialect.above};
  auto found = Clock::find(head, at.options.time, at.options.latest_ns);
  if (const auto* problem = std::get_if<Clock::Problem>(&found)) return refuse(*problem);
  at.clock = std::get<Clock>(std::move(found));
  if (const std::string& by = at.clock->local_by();
      !by.empty() && !at.options.any_epoch && !at.options.force_times)
    return Error{fmt::format(
        "{}: by {} the time is a local one; say of which zone with --time-zone, as Europe/Berlin, "
        "+01:00 or UTC, or name another column with --time",
        at.rows.source().name(), by)};
  at.clock_at_start = at.clock;
  if (!at.options.force_times) {
    auto problem = of_one_spacecraft ? several_spacecraft(head, *at.clock) : std::nullopt;
    if (!problem && !at.options.time.column) problem = clocks_of_their_own(head);
    if (!problem && !is_series_after_series) problem = repeated_times(head, *at.clock);
    if (problem) return refuse(*problem);
  }
  at.start_watch();
  return std::nullopt;
}

const Clock& TelemetryFile::clock() const {
  return *impl_->clock;
}

bool TelemetryFile::is_time(std::size_t column) const {
  return impl_->clock && impl_->clock->uses(column);
}

std::string TelemetryFile::found() const {
  const Impl& at = *impl_;
  if (at.made_of) return at.made_of->found;
  std::string text = describe(at.dialect);
  if (at.style.decimal == ',') text += ", decimal commas";
  if (at.style.thousands != '\0') text += fmt::format(", thousands with '{}'", at.style.thousands);
  text += ", " + at.rows.source().encoding();
  if (at.clock)
    text += ", time: " + (at.clock->description().empty() ? "none yet" : at.clock->description());
  for (std::size_t c = 0; c < at.formats.size(); ++c) {
    if (is_time(c)) continue;
    const std::string format = describe(at.formats[c]);
    if (!format.empty()) text += fmt::format("; {}: {}", at.dialect.columns[c], format);
  }
  return text;
}

bool TelemetryFile::has_samples_of_their_own() const {
  return impl_->made_of.has_value();
}

std::vector<std::string> TelemetryFile::unnamed_columns() const {
  std::vector<std::string> sentences;
  for (std::size_t c = 0; c < columns().size(); ++c)
    if (columns()[c].empty() && format(c).kind != CellFormat::Kind::empty && !is_time(c))
      sentences.push_back(fmt::format(
          "column {} has no name and is left out; --names gives each column one", c + 1));
  return sentences;
}

/// Where times and names may be read otherwise: columns of other times beside the clock, names in a
/// one-byte encoding that are no words of Latin letters.
std::vector<std::string> TelemetryFile::Impl::other_readings() const {
  std::vector<std::string> sentences, others;
  for (std::size_t c = 0; clock && c < formats.size(); ++c) {
    const auto& own = head_columns[clock->columns().front()];
    if (clock->uses(c) || formats[c].kind != CellFormat::Kind::text || head_columns[c].empty())
      continue;
    const auto date = read_date_text(head_columns[c].front(), DateOrder::day_first);
    if (date && date->has_date && head_columns[c] != own) others.push_back(dialect.columns[c]);
  }
  if (!others.empty())
    sentences.push_back(fmt::format(
        "{}: there are other times in {}; each value is taken at '{}' (--time names another "
        "column)",
        rows.source().name(), joined(others), dialect.columns[clock->columns().front()]));
  std::size_t latin = 0, other = 0;
  for (const std::string& column : dialect.columns)
    for (const char c : column) {
      latin += (c | 0x20) >= 'a' && (c | 0x20) <= 'z' ? 1U : 0U;
      other += (c & 0xC0) == 0xC0 ? 1U : 0U;  // begins a character beyond ASCII
    }
  const std::string encoding = rows.source().encoding();
  if (!options.encoding && other > latin &&
      (encoding == "ISO-8859-1" || encoding == "WINDOWS-1252"))
    sentences.push_back(
        fmt::format("{}: the names were read in {}; where they are not such letters, --encoding "
                    "names another, as GB18030, CP949 or CP1251",
                    rows.source().name(), encoding));
  return sentences;
}

std::vector<std::string> TelemetryFile::remarks() const {
  const RowReader& rows = impl_->rows;
  if (impl_->made_of) return impl_->made_of->remarks;
  std::vector<std::string> remarks = impl_->other_readings();
  if (rows.repeated_headers() > 0)
    remarks.push_back(
        fmt::format("{}:{}: the header stands here again, as where files were joined ({} in all)",
                    rows.source().name(), rows.first_repeated_header(), rows.repeated_headers()));
  if (impl_->watch && impl_->watch->hour_ahead_line() > 0)
    remarks.push_back(fmt::format(
        "{}:{}: the clock goes ahead an hour: telemetry is missing, or it is a local time at the "
        "beginning of daylight saving; --time-zone names its zone",
        rows.source().name(), impl_->watch->hour_ahead_line()));
  if (rows.cut_line() > 0)
    remarks.push_back(fmt::format("{}:{}: the last line was cut, or is no row, and is left out",
                                  rows.source().name(), rows.cut_line()));
  return remarks;
}

TelemetryFile::Step TelemetryFile::next() {
  Impl& at = *impl_;
  at.damage = Damage::none;
  const Step step = at.rows.next();
  ++at.rows_read;
  if (step == Step::error) return at.fail(at.rows.damage(), at.rows.error());
  if (step == Step::row && at.rows.has_nul_bytes())
    return at.fail(Damage::nul_bytes, at.rows.error_here({}));
  if (step == Step::end || at.clock) return step == Step::end ? step : at.read_time();
  return at.is_another_header() ? at.fail_at_header() : step;
}

/// Whether a row names columns in another order, as where another file was joined.
bool TelemetryFile::Impl::is_another_header() const {
  const auto is_name = [&](std::string_view cell) {
    cell = trimmed(cell);
    return !cell.empty() &&
           std::find(dialect.columns.begin(), dialect.columns.end(), cell) != dialect.columns.end();
  };
  const auto cells = rows.cells();
  const auto first = std::find_if(cells.begin(), cells.end(),
                                  [](std::string_view cell) { return !trimmed(cell).empty(); });
  if (dialect.header_line == 0 || first == cells.end() || !is_name(*first)) return false;
  const auto names = std::count_if(cells.begin(), cells.end(), is_name);
  const bool is_same =
      std::equal(cells.begin(), cells.end(), dialect.columns.begin(), dialect.columns.end(),
                 [](std::string_view a, const auto& b) { return trimmed(a) == b; });
  return !is_same && 2 * names >= static_cast<std::ptrdiff_t>(cells.size());
}

TelemetryFile::Step TelemetryFile::Impl::fail_at_header() {
  return fail(Damage::none,
              rows.error_here("another header stands here, as where files were joined, and its "
                              "columns are others or in another order; divide the file there"));
}

void TelemetryFile::Impl::start_watch() {
  watch.emplace(clock->unit_ns(), clock->counts_since(), clock->may_be_local(),
                clock->is_newest_first());
  ahead_ns = 0;
}

/// Notes a row's time by its clock, and makes that of the row of it.
void TelemetryFile::Impl::follow(std::int64_t clock_ns) {
  step = watch->next(clock_ns, rows.line());
  if (step && options.continues_clock)
    ahead_ns += clock->is_newest_first() ? -step->missing_ns : step->missing_ns;
  if (__builtin_add_overflow(clock_ns, ahead_ns, &time_ns)) time_ns = clock_ns;
}

TelemetryFile::Step TelemetryFile::Impl::read_time() {
  const std::size_t column = clock->columns().front();
  const auto time = clock->read(rows.cells());
  if (!time && is_another_header()) return fail_at_header();
  const auto here = [&](std::string_view what) {
    return rows.error_here(fmt::format("{} in column '{}' {}", shown(rows.cells()[column]),
                                       dialect.columns[column], what));
  };
  if (!time) {
    return fail(
        Damage::time,
        here(clock->description().empty()
                 ? std::string("is no time; use 2023-04-29T16:22:37.5Z or seconds since 1970-01-01 "
                               "UTC, or say what it is with --time-format, --time-unit or --epoch")
                 : "is no time as the others (" + clock->description() +
                       "); mend it, or leave such rows out with --skip-bad-lines" +
                       comment_advice(rows.cells().front())));
  }
  time_ns = *time;
  const bool is_possible =
      clock->is_absolute() && time_ns >= earliest_ns && time_ns <= options.latest_ns;
  if (!options.force_times && !options.any_epoch && !is_possible)
    return fail(
        Damage::none,
        here(fmt::format("would be {}, {}: say {}, or that it is right with --force-times",
                         time_text(time_ns),
                         time_ns < earliest_ns         ? "before 1990"
                         : time_ns > options.latest_ns ? "later than tomorrow"
                                                       : "if it counted since 1970",
                         clock->is_absolute() ? "what it is with --time-format or --time-unit"
                                              : "since when it counts with --epoch, or what it is "
                                                "with --time-format or --time-unit")));
  follow(time_ns);
  if (step && step->kind != ClockStep::Kind::out_of_order && !options.clock_may_go_back) {
    const std::string_view remedy =
        step->kind == ClockStep::Kind::half_day
            ? "write the times with 24 hours, or with AM and PM, or go on with --clock-back go-on"
        : step->kind == ClockStep::Kind::hour
            ? "name the zone with --time-zone, as Europe/Berlin, from the first line on, or go on "
              "with --clock-back go-on"
            : "go on with --clock-back go-on, or import each part by itself with its own --epoch";
    return fail(Damage::none, rows.error_here(fmt::format("{}; {}", step->what, remedy)));
  }
  return Step::row;
}

std::span<const std::string_view> TelemetryFile::cells() const {
  return impl_->rows.cells();
}
Cell TelemetryFile::cell(std::size_t column) const {
  return read_cell(impl_->rows.cells()[column], impl_->formats[column]);
}
std::int64_t TelemetryFile::time_ns() const {
  return impl_->time_ns;
}
const std::optional<ClockStep>& TelemetryFile::clock_step() const {
  return impl_->step;
}
std::uint64_t TelemetryFile::line() const {
  return impl_->line_of(impl_->rows_read - 1, impl_->rows.line());
}
std::uint64_t TelemetryFile::line(std::size_t column) const {
  return impl_->line_of(impl_->rows_read - 1, column, impl_->rows.line());
}
const Error& TelemetryFile::error() const {
  return impl_->error;
}
Damage TelemetryFile::damage() const {
  return impl_->damage;
}
Error TelemetryFile::error_here(std::string_view what) const {
  return Error{fmt::format("{}:{}: {}", impl_->rows.source().name(), line(), what)};
}
Error TelemetryFile::cell_error(std::size_t column, std::string_view what) const {
  return Error{fmt::format("{}:{}: {} in column '{}' {}", impl_->rows.source().name(), line(column),
                           shown(cells()[column]), columns()[column], what)};
}
std::uint64_t TelemetryFile::bytes_read() const {
  return impl_->rows.bytes_read();
}
std::uint64_t TelemetryFile::next_line() const {
  return impl_->rows.next_line();
}
std::uint64_t TelemetryFile::size() const {
  return impl_->rows.source().size();
}

std::optional<Error> TelemetryFile::go_on_at(std::uint64_t position, std::uint64_t line) {
  Impl& at = *impl_;
  at.clock = at.clock_at_start;
  if (at.clock) at.start_watch();
  const bool depends_on_rows_before =
      at.clock && (at.clock->depends_on_order() || at.options.continues_clock);
  if (depends_on_rows_before && position > at.dialect.first_position) {
    if (auto error =
            at.rows.start(at.dialect.layout, at.dialect.first_position, at.dialect.first_line))
      return error;
    while (at.rows.bytes_read() < position) {
      const Step step = at.rows.next();
      if (step == Step::end) break;
      if (step != Step::row) continue;
      if (const auto time = at.clock->read(at.rows.cells())) at.follow(*time);
    }
  }
  return at.rows.start(at.dialect.layout, position, line);
}

void LeftOut::add(Damage damage, const Error& error) {
  for (Kind& kind : kinds_)
    if (kind.damage == damage) {
      ++kind.count;
      return;
    }
  kinds_.push_back({damage, 1, error.message});
}

std::uint64_t LeftOut::count() const {
  std::uint64_t count = 0;
  for (const Kind& kind : kinds_) count += kind.count;
  return count;
}

std::vector<std::string> LeftOut::sentences() const {
  std::vector<std::string> sentences;
  for (const Kind& kind : kinds_)
    sentences.push_back(fmt::format("{} {} left out for {}, the first: {}", kind.count,
                                    kind.count == 1 ? "row" : "rows", name(kind.damage),
                                    kind.first));
  return sentences;
}

}  // namespace reident::telemetry_file
