#include "service/satcs/replay/replay.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "service/satcs/replay/replay_columns.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

using csv::Error;
using csv::Reader;

/// What a first reading of the file found.
struct Survey {
  std::vector<std::uint64_t> numbers;  // cells with a number, for each column of the file
  std::vector<storage::Time> times;
};

std::variant<Survey, Error> survey(const ReplayOptions& options, std::size_t time_position) {
  auto opened = Reader::open(options.file);
  if (auto* error = std::get_if<Error>(&opened)) return std::move(*error);
  auto& reader = std::get<Reader>(opened);
  Survey result;
  result.numbers.resize(reader.columns().size());
  Reader::Step step = reader.next();
  for (; step == Reader::Step::row; step = reader.next()) {
    const auto time = reader.time_at(time_position);
    if (const auto* error = std::get_if<Error>(&time)) return *error;
    result.times.push_back(std::get<std::int64_t>(time));
    const auto cells = reader.cells();
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (csv::to_number(cells[c])) ++result.numbers[c];
    }
  }
  if (step == Reader::Step::error) return reader.error();
  return result;
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

Reader reopened(const std::filesystem::path& file) {
  auto opened = Reader::open(file);
  if (const auto* error = std::get_if<Error>(&opened)) throw std::runtime_error(error->message);
  return std::get<Reader>(std::move(opened));
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
  auto opened = Reader::open(options.file);
  if (auto* error = std::get_if<Error>(&opened)) return std::move(*error);
  auto& head = std::get<Reader>(opened);
  const Reader::Step first = head.next();
  if (first == Reader::Step::error) return head.error();
  if (first == Reader::Step::end) {
    return Error{file + ": the header is not followed by a row; there is nothing to replay"};
  }
  const auto time_position = find_time_column(head, options.time_column);
  if (const auto* error = std::get_if<Error>(&time_position)) return *error;

  ReplayPlan plan;
  plan.file = options.file;
  plan.skip_blanks = options.skip_blanks;
  plan.time_position = std::get<std::size_t>(time_position);
  plan.time_column = head.columns()[plan.time_position];
  auto surveyed = survey(options, plan.time_position);
  if (auto* error = std::get_if<Error>(&surveyed)) return std::move(*error);
  const auto& [numbers, times] = std::get<Survey>(surveyed);
  if (auto error = choose_columns(options, head, numbers, plan)) return *std::move(error);

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
    : plan_(std::move(plan)), reader_(reopened(plan_.file)), sender_(std::move(sender)) {}

std::vector<storage::ParameterDescriptor> ReplayStream::parameters() const {
  std::vector<storage::ParameterDescriptor> parameters;
  for (const auto& column : plan_.columns) parameters.push_back(column.parameter);
  return parameters;
}

bool ReplayStream::next(storage::TelemetryFrame& frame) {
  while (true) {
    const Reader::Step step = reader_.next();
    if (step == Reader::Step::end) return false;
    if (step == Reader::Step::error) throw std::runtime_error(reader_.error().message);
    const auto time = reader_.time_at(plan_.time_position);
    if (const auto* error = std::get_if<Error>(&time)) throw std::runtime_error(error->message);
    frame.generation_time = frame.reception_time = std::get<std::int64_t>(time);
    if (within(plan_.range, frame.generation_time)) break;
  }
  frame.source = sender_.source;
  frame.origin = sender_.origin;
  frame.sequence = sender_.first_sequence + rows_done_;
  frame.samples.clear();
  for (const auto& column : plan_.columns) {
    const auto& cell = reader_.cells()[column.position];
    if (plan_.skip_blanks && trimmed(cell).empty()) continue;
    const auto number = csv::to_number(cell);
    frame.samples.push_back({column.parameter.id,
                             number ? storage::Quality::good : storage::Quality::invalid,
                             number.value_or(std::numeric_limits<double>::quiet_NaN())});
  }
  ++rows_done_;
  return true;
}

double ReplayStream::progress() const {
  return static_cast<double>(rows_done_) / static_cast<double>(plan_.rows);
}

}  // namespace reident::satcs
