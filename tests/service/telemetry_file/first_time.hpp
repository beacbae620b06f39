// The time that is read of the first row of a file.
#pragma once

#include <string>
#include <vector>

#include "service/support/time_text.hpp"
#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::telemetry_file::test {

inline constexpr std::int64_t in_2026 = 1'780'000'000'000'000'000;

/// The time of the first row below a header with the column `name`, or the error; above it stand
/// the lines of `above`.
inline std::string first_time(const std::string& names, const std::vector<std::string>& cells,
                              const TimeOptions& time = {}, const std::string& above = {}) {
  ReadingOptions options;
  options.time = time;
  options.latest_ns = in_2026;
  std::string text = above + names + ",x\n";
  for (const std::string& cell : cells) text += cell + ",1.5\n";
  auto opened = TelemetryFile::of_text(text, "t.csv", options);
  if (const auto* error = std::get_if<Error>(&opened)) return error->message;
  auto& file = std::get<TelemetryFile>(opened);
  if (const auto error = file.find_time()) return error->message;
  return file.next() == TelemetryFile::Step::row ? time_text(file.time_ns()) : file.error().message;
}

}  // namespace reident::telemetry_file::test
