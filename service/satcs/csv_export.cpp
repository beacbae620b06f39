#include "service/satcs/csv_export.hpp"

#include <cstdlib>
#include <iterator>
#include <optional>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

#include "service/support/progress.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

constexpr std::size_t bytes_at_once = 1 << 16;

void append_time(std::string& row, storage::Time time) {
  const auto [seconds, nanoseconds] = std::div(time, storage::second_ns);
  if (time < 0 && seconds == 0) row += '-';
  fmt::format_to(std::back_inserter(row), "{}", seconds);
  if (nanoseconds != 0) {
    fmt::format_to(std::back_inserter(row), ".{:09}", std::abs(nanoseconds));
  }
}

}  // namespace

bool write_csv(FrameStream& stream, OutputFile& file, const std::stop_token& stop) {
  std::string rows = "unix_s";
  std::unordered_map<std::uint32_t, std::size_t> column;
  for (const auto& parameter : stream.parameters()) {
    column.emplace(parameter.id, column.size());
    rows += "," + parameter.name;
  }
  rows += '\n';
  Progress progress;
  storage::TelemetryFrame frame;
  std::vector<std::optional<double>> cells;
  while (!stop.stop_requested() && stream.next(frame)) {
    cells.assign(column.size(), std::nullopt);
    for (const auto& sample : frame.samples) {
      if (sample.quality != storage::Quality::invalid)
        cells[column.at(sample.parameter)] = sample.value;
    }
    append_time(rows, frame.generation_time);
    for (const auto& cell : cells) {
      rows += ',';
      if (cell) fmt::format_to(std::back_inserter(rows), "{}", *cell);
    }
    rows += '\n';
    if (rows.size() < bytes_at_once) continue;
    file.write(rows);
    rows.clear();
    if (progress.due()) progress.update(stream.progress(), time_text(frame.generation_time));
  }
  if (stop.stop_requested()) return false;
  file.write(rows);
  file.finish();
  return true;
}

}  // namespace reident::satcs
