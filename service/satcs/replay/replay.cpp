#include "service/satcs/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "service/satcs/replay/replay_columns.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/long_layout.hpp"

namespace reident::satcs {
namespace {

using csv::Error;
using telemetry_file::Cell;
using telemetry_file::TelemetryFile;

constexpr std::size_t examples = 3;  // of what is no number, a column

/// What a first reading of the file found.
struct Survey {
  std::vector<std::uint64_t> numbers;  // cells with a number, for each column of the file
  std::vector<std::uint64_t> bad;      // cells that are no numbers and no blanks
  std::vector<std::string> first_bad;  // "'x' in line 7, ..."
  std::vector<storage::Time> times;
  telemetry_file::LeftOut left_out;
  std::vector<std::string> remarks;
};

void count_cells(const TelemetryFile& reader, Survey& result) {
  for (std::size_t c = 0; c < result.numbers.size(); ++c) {
    const auto cell = reader.cell(c);
    if (cell.kind == Cell::Kind::number && std::isfinite(cell.value)) ++result.numbers[c];
    if (cell.kind != Cell::Kind::bad) continue;
    if (result.bad[c]++ >= examples) continue;
    std::string& text = result.first_bad[c];
    text += (text.empty() ? "'" : ", '") + std::string(trimmed(reader.cells()[c]).substr(0, 40)) +
            "' in line " + std::to_string(reader.line(c));
  }
}

std::variant<Survey, Error> survey(TelemetryFile& reader, bool skip_bad_lines) {
  Survey result;
  result.numbers.resize(reader.columns().size());
  result.bad.resize(reader.columns().size());
  result.first_bad.resize(reader.columns().size());
  std::uint64_t steps_back = 0;
  for (auto step = reader.next(); step != TelemetryFile::Step::end; step = reader.next()) {
    if (step == TelemetryFile::Step::error) {
      if (!skip_bad_lines || reader.damage() == telemetry_file::Damage::none) return reader.error();
      result.left_out.add(reader.damage(), reader.error());
      continue;
    }
    result.times.push_back(reader.time_ns());
    if (reader.clock_step() && steps_back++ == 0)
      result.remarks.push_back(reader.error_here(reader.clock_step()->what).message);
    count_cells(reader, result);
  }
  if (steps_back > 1)
    result.remarks.push_back("the clock goes back " + std::to_string(steps_back) + " times");
  for (const auto& remark : reader.remarks()) result.remarks.push_back(remark);
  for (const auto& sentence : result.left_out.sentences()) result.remarks.push_back(sentence);
  return result;
}

void say_cells(const TelemetryFile& reader, const Survey& surveyed, ReplayPlan& plan) {
  for (const auto& column : plan.columns)
    if (const auto c = column.position; surveyed.bad[c] > 0)
      plan.remarks.push_back(
          "column '" + reader.columns()[c] + "': " + std::to_string(surveyed.bad[c]) +
          " cells are no numbers and are sent as invalid: " + surveyed.first_bad[c]);
  for (const auto& sentence : reader.unnamed_columns()) plan.remarks.push_back(sentence);
  for (const auto& column : plan.left_out)
    if (surveyed.bad[std::get<std::size_t>(reader.find(column))] > 0)
      plan.remarks.push_back(left_out_sentence(reader, column));
}

/// The range that the options ask for, in a file whose earliest and latest rows are given.
storage::TimeRange chosen_range(const ReplayOptions& options, storage::Time earliest) {
  using Limits = std::numeric_limits<storage::Time>;
  const auto resolve = [&](const std::optional<ReplayBound>& bound, storage::Time absent) {
    if (!bound) return absent;
    storage::Time time = bound->ns;
    // An offset beyond what can be held is beyond every row.
    if (bound->relative && __builtin_add_overflow(earliest, bound->ns, &time)) return Limits::max();
    return time;
  };
  return {resolve(options.start, Limits::min()), resolve(options.end, Limits::max())};
}

bool within(storage::TimeRange range, storage::Time time) {
  return range.begin <= time && time < range.end;
}

std::variant<TelemetryFile, Error> opened_with_time(const std::filesystem::path& file,
                                                    const telemetry_file::ReadingOptions& reading,
                                                    bool skip_bad_lines) {
  auto opened = telemetry_file::open_as_table(file, reading, skip_bad_lines);
  if (auto* reader = std::get_if<TelemetryFile>(&opened); reader && reader->has_rows())
    if (auto error = reader->find_time()) return *std::move(error);
  return opened;
}

TelemetryFile reopened(const ReplayPlan& plan) {
  auto opened = opened_with_time(plan.file, plan.reading, plan.skip_bad_lines);
  if (const auto* error = std::get_if<Error>(&opened)) throw std::runtime_error(error->message);
  return std::get<TelemetryFile>(std::move(opened));
}

}  // namespace

std::optional<ColumnMapping> parse_mapping(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  ColumnMapping mapping{
      std::string(text.substr(0, equals)), std::string(text.substr(equals + 1)), {}};
  if (const auto colon = mapping.parameter.rfind(':'); colon != std::string::npos) {
    mapping.unit = mapping.parameter.substr(colon + 1);
    mapping.parameter.resize(colon);
  }
  if (mapping.column.empty() || mapping.parameter.empty()) return std::nullopt;
  return mapping;
}

std::optional<ReplayBound> parse_bound(std::string_view text) {
  if (!text.empty() && text.front() != '+') {
    if (const auto time = parse_time(text)) return ReplayBound{false, *time};
  }
  const auto offset = parse_duration(text);
  if (!offset || *offset < 0) return std::nullopt;
  return ReplayBound{true, *offset};
}

std::variant<ReplayPlan, Error> plan_replay(const ReplayOptions& options) {
  const std::string file = options.file.string();
  std::error_code failed;
  if (std::filesystem::exists(options.file, failed) &&
      !std::filesystem::is_regular_file(options.file, failed) &&
      !std::filesystem::is_directory(options.file, failed)) {
    return Error{file + ": is no regular file and cannot be read twice; save it as one first"};
  }
  auto opened = opened_with_time(options.file, options.reading, options.skip_bad_lines);
  if (auto* error = std::get_if<Error>(&opened)) return std::move(*error);
  auto& reader = std::get<TelemetryFile>(opened);
  if (!reader.has_rows())
    return Error{file + ": the header is not followed by a row; there is nothing to replay"};

  ReplayPlan plan;
  plan.file = options.file;
  plan.reading = options.reading;
  plan.invalid_blanks = options.invalid_blanks && !reader.has_samples_of_their_own();
  plan.skip_bad_lines = options.skip_bad_lines;
  plan.time_column = reader.columns()[reader.clock().columns().front()];
  plan.found = reader.found();
  auto surveyed = survey(reader, options.skip_bad_lines);
  if (auto* error = std::get_if<Error>(&surveyed)) return std::move(*error);
  auto& seen = std::get<Survey>(surveyed);
  if (auto error = choose_columns(options, reader, seen.numbers, plan)) return *std::move(error);
  plan.remarks = std::move(seen.remarks);
  say_cells(reader, seen, plan);
  const auto& times = seen.times;
  if (times.empty()) return Error{file + ": every row is bad; there is nothing to replay"};

  const auto [earliest, latest] = std::minmax_element(times.begin(), times.end());
  plan.range = chosen_range(options, *earliest);
  plan.rows = static_cast<std::uint64_t>(std::count_if(
      times.begin(), times.end(), [&](storage::Time time) { return within(plan.range, time); }));
  if (plan.rows == 0) {
    return Error{file + ": no row lies between the start and the end asked for; the rows go from " +
                 time_text(*earliest) + " to " + time_text(*latest)};
  }
  return plan;
}

ReplayStream::ReplayStream(ReplayPlan plan, Sender sender)
    : plan_(std::move(plan)), reader_(reopened(plan_)), sender_(std::move(sender)) {}

std::vector<storage::ParameterDescriptor> ReplayStream::parameters() const {
  std::vector<storage::ParameterDescriptor> parameters;
  for (const auto& column : plan_.columns) parameters.push_back(column.parameter);
  return parameters;
}

bool ReplayStream::next(storage::TelemetryFrame& frame) {
  while (true) {
    const auto step = reader_.next();
    if (step == TelemetryFile::Step::end) return false;
    if (step == TelemetryFile::Step::error) {
      if (plan_.skip_bad_lines && reader_.damage() != telemetry_file::Damage::none) continue;
      throw std::runtime_error(reader_.error().message);
    }
    frame.generation_time = frame.reception_time = reader_.time_ns();
    if (within(plan_.range, frame.generation_time)) break;
  }
  frame.source = sender_.source;
  frame.origin = sender_.origin;
  frame.sequence = sender_.first_sequence + rows_done_;
  frame.first_sequence = sender_.first_sequence;
  frame.samples.clear();
  for (const auto& column : plan_.columns) {
    const Cell cell = reader_.cell(column.position);
    if ((!plan_.invalid_blanks && cell.kind == Cell::Kind::blank) ||
        cell.kind == Cell::Kind::missing)
      continue;
    const bool is_value = cell.kind == Cell::Kind::number && std::isfinite(cell.value);
    const auto quality = !is_value         ? storage::Quality::invalid
                         : cell.is_flagged ? storage::Quality::out_of_limits
                                           : storage::Quality::good;
    frame.samples.push_back({column.parameter.id, quality,
                             is_value ? cell.value : std::numeric_limits<double>::quiet_NaN()});
  }
  ++rows_done_;
  return true;
}

double ReplayStream::progress() const {
  return static_cast<double>(rows_done_) / static_cast<double>(plan_.rows);
}

}  // namespace reident::satcs
