#include "service/satcs/csv_export.hpp"

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

namespace reident::satcs {
namespace {

void append_time(std::string& row, storage::Time time) {
  const auto [seconds, nanoseconds] = std::div(time, storage::second_ns);
  if (time < 0 && seconds == 0) row += '-';
  fmt::format_to(std::back_inserter(row), "{}", seconds);
  if (nanoseconds != 0) {
    fmt::format_to(std::back_inserter(row), ".{:09}", std::abs(nanoseconds));
  }
}

}  // namespace

void write_csv(FrameStream& stream, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  std::string row = "unix_s";
  std::unordered_map<std::uint32_t, std::size_t> column;
  for (const auto& parameter : stream.parameters()) {
    column.emplace(parameter.id, column.size());
    row += "," + parameter.name;
  }
  file << row << '\n';
  storage::TelemetryFrame frame;
  std::vector<std::optional<double>> cells;
  while (file && stream.next(frame)) {
    cells.assign(column.size(), std::nullopt);
    for (const auto& sample : frame.samples) {
      if (sample.quality != storage::Quality::invalid)
        cells[column.at(sample.parameter)] = sample.value;
    }
    row.clear();
    append_time(row, frame.generation_time);
    for (const auto& cell : cells) {
      row += ',';
      if (cell) fmt::format_to(std::back_inserter(row), "{}", *cell);
    }
    file << row << '\n';
  }
  file.flush();
  if (!file) {
    throw std::runtime_error(path.string() + ": cannot be written: " +
                             std::error_code(errno, std::generic_category()).message());
  }
}

}  // namespace reident::satcs
