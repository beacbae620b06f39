#include "service/telemetry_file/reading_options.hpp"

#include <array>
#include <charconv>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/long_layout.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

constexpr int rows_shown = 3;

struct CharName {
  std::string_view name;
  char is;
};
constexpr std::array<CharName, 9> char_names = {{{"comma", ','},
                                                 {"semicolon", ';'},
                                                 {"tab", '\t'},
                                                 {"bar", '|'},
                                                 {"blank", ' '},
                                                 {"point", '.'},
                                                 {"apostrophe", '\''},
                                                 {"none", '\0'},
                                                 {"\\t", '\t'}}};

/// A character by itself or by its name.
std::optional<char> char_of(const std::string& text) {
  for (const CharName& known : char_names)
    if (known.name == text) return known.is;
  return text.size() == 1 ? std::optional(text.front()) : std::nullopt;
}

Error wrong(std::string_view flag, const std::string& text, std::string_view takes) {
  return {fmt::format("{} {} is not {}", flag, text, takes)};
}

/// The number of a line, or 0 for none.
std::optional<Error> take_line(std::string_view flag, const std::optional<std::string>& text,
                               std::optional<std::uint64_t>& line) {
  if (!text) return std::nullopt;
  std::uint64_t number = 0;
  if (*text != "none") {
    const char* const last = text->data() + text->size();
    const auto [end, error] = std::from_chars(text->data(), last, number);
    if (error != std::errc{} || end != last || number == 0)
      return wrong(flag, *text, "the number of a line, or none");
  }
  line = number;
  return std::nullopt;
}

std::optional<Error> take_dialect(const ReadingArguments& arguments, ReadingOptions& options) {
  DialectOptions& dialect = options.dialect;
  if (arguments.separator) {
    dialect.separator = char_of(*arguments.separator);
    if (!dialect.separator || *dialect.separator == '\0')
      return wrong("--separator", *arguments.separator,
                   "comma, semicolon, tab, bar, blank or one character");
  }
  if (auto error = take_line("--header", arguments.header, dialect.header_line)) return error;
  if (auto error = take_line("--units", arguments.units, dialect.units_line)) return error;
  if (arguments.line_end) {
    if (*arguments.line_end != "lf" && *arguments.line_end != "cr")
      return wrong("--line-end", *arguments.line_end, "lf or cr");
    dialect.line_end = *arguments.line_end == "cr" ? '\r' : '\n';
  }
  dialect.names = arguments.names;
  dialect.comment = arguments.comment;
  options.encoding = arguments.encoding;
  return std::nullopt;
}

std::optional<Error> take_cells(const ReadingArguments& arguments, ReadingOptions& options) {
  if (arguments.decimal || arguments.thousands) {
    NumberStyle style;
    const auto decimal = char_of(arguments.decimal.value_or("point"));
    if (!decimal || (*decimal != '.' && *decimal != ','))
      return wrong("--decimal", *arguments.decimal, "point or comma");
    style.decimal = *decimal;
    const auto thousands = char_of(arguments.thousands.value_or("none"));
    if (!thousands || std::string_view(",. '_").find(*thousands) == std::string_view::npos)
      if (!thousands || *thousands != '\0')
        return wrong("--thousands", *arguments.thousands,
                     "none, comma, point, blank or apostrophe");
    style.thousands = *thousands;
    if (!arguments.decimal && style.thousands == '.') style.decimal = ',';
    if (!arguments.thousands && style.decimal == ',') style.thousands = '\0';
    if (style.thousands == style.decimal)
      return Error{"--decimal and --thousands are the same; give them different marks"};
    options.cells.style = style;
  }
  options.cells.missing = arguments.missing;
  for (const std::string& text : arguments.map_states) {
    const std::size_t colon = text.rfind(':', std::min(text.find('='), text.size()));
    const std::string column = colon == std::string::npos ? "" : text.substr(0, colon);
    const auto states =
        parse_states(std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1));
    if (!states)
      return wrong("--map-states", text, "[COLUMN:]STATE=NUMBER,..., such as heater:OFF=0,ON=1");
    options.cells.states.emplace_back(column, *states);
  }
  return std::nullopt;
}

std::optional<Error> take_time(const ReadingArguments& arguments, ReadingOptions& options) {
  TimeOptions& time = options.time;
  time.column = arguments.time;
  time.zone = arguments.time_zone;
  if (arguments.time_format) {
    const std::string& text = *arguments.time_format;
    time.format = text == "iso" || text == "dmy" || text == "mdy" || text == "ymd"
                      ? TimeFormat::text
                      : parse_time_format(text);
    if (!time.format)
      return wrong("--time-format", text, "one of iso, dmy, mdy, ymd, " + time_format_names());
    if (text == "dmy") time.order = DateOrder::day_first;
    if (text == "mdy") time.order = DateOrder::month_first;
    if (text == "ymd") time.order = DateOrder::year_first;
  }
  if (arguments.time_unit) {
    time.unit_ns = parse_time_unit(*arguments.time_unit);
    if (!time.unit_ns)
      return wrong("--time-unit", *arguments.time_unit,
                   "one of ns, us, ms, s, min, h, d, or so many of it, as 10ms");
  }
  if (arguments.epoch) {
    time.epoch_ns = parse_time(*arguments.epoch);
    if (!time.epoch_ns)
      return wrong("--epoch", *arguments.epoch, "a time such as 2024-02-28T22:00:00Z");
  }
  if (arguments.clock_back && *arguments.clock_back != "stop" && *arguments.clock_back != "go-on")
    return wrong("--clock-back", *arguments.clock_back, "stop or go-on");
  options.clock_may_go_back = options.continues_clock = arguments.clock_back == "go-on";
  options.force_times = arguments.force_times;
  return std::nullopt;
}

std::string shown(const Cell& cell, std::string_view text) {
  switch (cell.kind) {
    case Cell::Kind::number:
      return fmt::format("{}", cell.value);
    case Cell::Kind::blank:
      return "blank";
    case Cell::Kind::missing:
      return "missing";
    case Cell::Kind::bad:
      break;
  }
  return "'" + std::string(trimmed(text)) + "'";
}

}  // namespace

void add_reading_options(CLI::App& app, ReadingArguments& arguments) {
  const std::string group = "How the file is read (found, and said, where not given)";
  const auto text = [&](const std::string& name, std::optional<std::string>& value,
                        const std::string& description, const std::string& type) {
    app.add_option(name, value, description)->type_name(type)->group(group);
  };
  text("--separator", arguments.separator, "comma, semicolon, tab, bar, blank or one character",
       "NAME");
  text("--decimal", arguments.decimal, "point or comma", "NAME");
  text("--thousands", arguments.thousands, "none, comma, point, blank or apostrophe", "NAME");
  text("--encoding", arguments.encoding, "as iconv names them: UTF-8, UTF-16LE, ISO-8859-1, ...",
       "NAME");
  text("--header", arguments.header, "line with the names of the columns, or none", "LINE");
  text("--units", arguments.units, "line below it with the units of the columns, or none", "LINE");
  text("--line-end", arguments.line_end, "lf (also of CR and LF) or cr", "NAME");
  app.add_option("--names", arguments.names, "names of the columns, separated by commas")
      ->delimiter(',')
      ->type_name("NAMES")
      ->group(group);
  text("--comment", arguments.comment, "what lines begin with that are no rows", "TEXT");
  text(
      "--time", arguments.time,
      "column of the time, or several separated by commas, as year,doy,sec_of_day (those that look "
      "like a time)",
      "COLUMN");
  text("--time-format", arguments.time_format,
       "iso, dmy, mdy, ymd, unix, elapsed, excel, mjd, jd, matlab, filetime, dotnet, gps", "NAME");
  text("--time-unit", arguments.time_unit,
       "what numbers of the time count: ns, us, ms, s, min, h, d, or 10ms", "UNIT");
  text("--time-zone", arguments.time_zone,
       "of times without an offset, as Europe/Berlin or +01:00 (UTC)", "ZONE");
  text("--epoch", arguments.epoch, "time since when numbers of the time count", "TIME");
  text("--clock-back", arguments.clock_back,
       "what happens where the clock was set back, restarted or wrapped: stop or go-on", "NAME");
  app.add_flag("--force-times", arguments.force_times,
               "take times before 1990 or later than tomorrow")
      ->group(group);
  app.add_option("--missing", arguments.missing,
                 "words and numbers that stand for no value, as -999 or n/a")
      ->type_name("VALUE...")
      ->group(group);
  app.add_option("--map-states", arguments.map_states,
                 "numbers of states, as heater:OFF=0,ON=1; may be given again")
      ->type_name("[COLUMN:]STATE=NUMBER,...")
      ->allow_extra_args(false)
      ->group(group);
  app.add_flag("--skip-bad-lines", arguments.skip_bad_lines,
               "leave out rows that cannot be read, and count them")
      ->group(group);
  app.add_flag("--dry-run", arguments.dry_run,
               "show the first three rows as they are understood, and do nothing")
      ->group(group);
}

std::variant<ReadingOptions, Error> reading_options(const ReadingArguments& arguments,
                                                    std::int64_t now_ns) {
  ReadingOptions options;
  options.latest_ns = now_ns + day_ns;
  if (auto error = take_dialect(arguments, options)) return *std::move(error);
  if (auto error = take_cells(arguments, options)) return *std::move(error);
  if (auto error = take_time(arguments, options)) return *std::move(error);
  return options;
}

std::variant<std::vector<std::string>, Error> dry_run(std::variant<TelemetryFile, Error> opened,
                                                      const std::filesystem::path& path,
                                                      bool needs_time, bool of_one_spacecraft) {
  if (auto* error = std::get_if<Error>(&opened)) return std::move(*error);
  auto& file = std::get<TelemetryFile>(opened);
  if (!file.has_rows())
    return Error{path.string() + ": the header is not followed by a row; there is nothing to show"};
  const bool is_of_samples = !file.has_samples_of_their_own() && find_long_layout(file);
  if (needs_time)
    if (auto error = file.find_time(is_of_samples, !is_of_samples || of_one_spacecraft))
      return *std::move(error);
  std::vector<std::string> lines = {path.string() + ": " + file.found()};
  for (int row = 0; row < rows_shown; ++row) {
    const auto step = file.next();
    if (step == TelemetryFile::Step::end) break;
    if (step == TelemetryFile::Step::error) {
      lines.push_back("bad row: " + file.error().message);
      if (file.damage() == Damage::none) break;
      continue;
    }
    std::string text = fmt::format("line {}:", file.line());
    if (needs_time) text += " " + time_text(file.time_ns());
    for (std::size_t c = 0; c < file.columns().size(); ++c) {
      if (file.is_time(c) || file.columns()[c].empty()) continue;
      text += fmt::format(" {}={}", file.columns()[c], shown(file.cell(c), file.cells()[c]));
      if (const std::string unit = file.unit(c);
          !unit.empty() && file.cell(c).kind == Cell::Kind::number)
        text += " " + unit;
    }
    lines.push_back(std::move(text));
  }
  for (std::string& remark : file.remarks()) lines.push_back(std::move(remark));
  return lines;
}

}  // namespace reident::telemetry_file
