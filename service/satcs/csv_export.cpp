#include "service/satcs/csv_export.hpp"

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <system_error>

#include <fmt/format.h>

namespace reident::satcs {
namespace {

void append_time(std::string& row, storage::Time time) {
  constexpr storage::Time second_ns = 1'000'000'000;
  const auto [seconds, nanoseconds] = std::div(time, second_ns);
  if (time < 0 && seconds == 0) row += '-';
  fmt::format_to(std::back_inserter(row), "{}", seconds);
  if (nanoseconds != 0) {
    fmt::format_to(std::back_inserter(row), ".{:09}", std::abs(nanoseconds));
  }
}

}  // namespace

void write_csv(FrameSource& source, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  std::string row = "unix_s";
  for (const auto& parameter : source.parameters()) row += "," + parameter.name;
  file << row << '\n';
  storage::Time time = 0;
  std::vector<storage::Sample> samples;
  while (file && source.next(time, samples)) {
    row.clear();
    append_time(row, time);
    for (const auto& sample : samples) {
      row += ',';
      if (sample.quality == storage::Quality::invalid) continue;
      fmt::format_to(std::back_inserter(row), "{}", sample.value);
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
