#include <algorithm>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/head_lines.hpp"
#include "service/telemetry_file/joined_blocks.hpp"
#include "service/telemetry_file/telemetry_file_impl.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::size_t head_bytes = std::size_t{1} << 20;
constexpr std::size_t head_rows = 20'000;
constexpr std::string_view another_header =
    "another header stands here, as where files were joined, and its columns or units are others "
    "or in another order; divide the file there";
constexpr std::int64_t earliest_ns = 631'152'000'000'000'000;  // 1990

}  // namespace

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
    if (const auto* question = std::get_if<StyleQuestion>(&found))
      return Error{fmt::format("{}:{}: {}", rows.source().name(), head_lines[question->row],
                               question->text)};
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
    if (of_one_spacecraft) at.spacecraft = spacecraft_columns(head, *at.clock);
    for (const SpacecraftColumn& column : at.spacecraft)
      if (const auto several = several_spacecraft(column, head)) return refuse(*several);
    std::optional<Clock::Problem> problem;
    if (!at.options.time.column) problem = clocks_of_their_own(head);
    if (!problem && !is_series_after_series) problem = repeated_times(head, *at.clock);
    if (!problem && !at.clock->is_newest_first()) problem = unpadded_parts(head, *at.clock);
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

TelemetryFile::Step TelemetryFile::next() {
  Impl& at = *impl_;
  at.damage = Damage::none;
  const Step step = at.rows.next();
  ++at.rows_read;
  if (auto other = at.of_another_file()) return at.fail(Damage::none, *std::move(other));
  if (step == Step::error) return at.fail(at.rows.damage(), at.rows.error());
  if (step == Step::row && at.rows.is_unended() && at.leaves_out_cut_row()) return Step::end;
  if (step == Step::row && at.rows.has_nul_bytes())
    return at.fail(Damage::nul_bytes, at.rows.error_here({}));
  if (step == Step::end || at.clock) return step == Step::end ? step : at.read_time();
  return at.is_another_header(at.rows.cells()) ? at.fail_at_header() : step;
}

/// Whether a row names columns in another order, as where another file was joined.
bool TelemetryFile::Impl::is_another_header(std::span<const std::string_view> cells) const {
  const auto is_name = [&](std::string_view cell) {
    cell = trimmed(cell);
    return !cell.empty() &&
           std::find(dialect.columns.begin(), dialect.columns.end(), cell) != dialect.columns.end();
  };
  const auto first = std::find_if(cells.begin(), cells.end(),
                                  [](std::string_view cell) { return !trimmed(cell).empty(); });
  if (dialect.header_line == 0 || first == cells.end() || !is_name(*first)) return false;
  const auto names = std::count_if(cells.begin(), cells.end(), is_name);
  const bool is_same =
      std::equal(cells.begin(), cells.end(), dialect.columns.begin(), dialect.columns.end(),
                 [](std::string_view a, const auto& b) { return trimmed(a) == b; });
  return !is_same && 2 * names >= static_cast<std::ptrdiff_t>(cells.size());
}

/// Whether a row names the column of the time and others than the header, or has other units than
/// the row of units.
bool TelemetryFile::Impl::has_other_units() const {
  const auto cells = rows.cells();
  const std::size_t column = clock->columns().front();
  if (dialect.header_line != 0 && trimmed(cells[column]) == dialect.columns[column])
    return !std::equal(cells.begin(), cells.end(), dialect.columns.begin(), dialect.columns.end(),
                       [](std::string_view a, const auto& b) { return trimmed(a) == b; });
  bool differ = false;
  for (std::size_t c = 0; c < cells.size() && !dialect.units.empty(); ++c) {
    const std::string_view cell = trimmed(cells[c]);
    if (!cell.empty() && !is_unit_word(cell)) return false;
    std::string_view bare = cell;
    if (bare.size() > 2 && (bare.front() == '[' || bare.front() == '('))
      bare = bare.substr(1, bare.size() - 2);
    differ = differ || (!bare.empty() && bare != dialect.units[c]);
  }
  return differ;
}

TelemetryFile::Step TelemetryFile::Impl::fail_at_header() {
  return fail(Damage::none, rows.error_here(another_header));
}

/// Notes whether the last row of a text without a line end is cut, by its last cell. Few rows above
/// it leave that open: where zeros at the end of decimals are not written, the last may lack some.
bool TelemetryFile::Impl::leaves_out_cut_row() {
  const std::string_view text = rows.text(), cell = rows.cells().back();
  const bool ends_the_line = !cell.empty() && text.ends_with(cell);
  if (!ends_the_line || !is_shorter_than_all(cell, head_columns.back(), style.decimal))
    return false;
  constexpr std::size_t enough_rows = 30;
  cut_number_line = rows.line();
  is_cut_left_out = head_columns.back().size() > enough_rows;
  return is_cut_left_out;
}

std::optional<Error> TelemetryFile::Impl::of_another_file() const {
  const bool of_lines = clock && clock->is_of_lines();
  const auto here = [this](std::uint64_t line, std::string_view what) {
    return Error{fmt::format("{}:{}: {}", rows.source().name(), line, what)};
  };
  std::vector<std::string_view> cells;
  for (const NumberedLine& comment : rows.comments()) {
    if (const auto other = said_otherwise(comment.text, dialect.above, of_lines))
      return here(comment.number, *other);
    std::string text(trimmed(std::string_view(comment.text).substr(dialect.layout.comment.size())));
    if (!split_cells(text, dialect.layout.separator, cells) &&
        cells.size() == dialect.columns.size() && is_another_header(cells))
      return here(comment.number, another_header);
  }
  if (rows.damage() == Damage::none) return std::nullopt;
  const auto other = said_otherwise(rows.text(), dialect.above, of_lines);
  return other ? std::optional(here(rows.line(), *other)) : std::nullopt;
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
  if (!time && (is_another_header(rows.cells()) || has_other_units())) return fail_at_header();
  const auto here = [&](std::string_view what) {
    return rows.error_here(fmt::format("{} in column '{}' {}", shown(rows.cells()[column]),
                                       dialect.columns[column], what));
  };
  if (!time) {
    if (const auto other = said_otherwise(rows.text(), dialect.above, clock->is_of_lines()))
      return fail(Damage::none, rows.error_here(*other));
    return fail(
        Damage::time,
        here(clock->description().empty()
                 ? std::string("is no time; use 2023-04-29T16:22:37.5Z or seconds since 1970-01-01 "
                               "UTC, or say what it is with --time-format, --time-unit or --epoch")
                 : "is no time as the others (" + clock->description() +
                       "); mend it, or leave such rows out with --skip-bad-lines" +
                       comment_advice(rows.cells().front())));
  }
  for (const SpacecraftColumn& of : spacecraft)
    if (const auto other = names_another(of, rows.cells()))
      return fail(Damage::none, rows.error_here(*other));
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

}  // namespace reident::telemetry_file
