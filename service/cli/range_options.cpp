#include "service/cli/range_options.hpp"

#include <fmt/format.h>

#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli {
namespace {

// Years 1823 to 2116: differences of two such times fit in 64 bits.
constexpr storage::Time sane_time = (storage::Time{1} << 62) - 1;

}  // namespace

std::optional<Refusal> read_telemetry_time(std::string_view flag,
                                           const std::optional<std::string>& text,
                                           storage::Time& time) {
  if (!text) return std::nullopt;
  const auto parsed = parse_moment(*text, utc_now());
  if (!parsed || *parsed > sane_time || *parsed < -sane_time)
    return Refusal{
        fmt::format("{} {} is no time of the years 1823 to 2116; write it as "
                    "2025-01-31T12:00:00Z",
                    flag, *text)};
  time = *parsed;
  return std::nullopt;
}

void add_range_options(CLI::App& command, RangeOptions& options, const std::string& otherwise) {
  command.add_option("--begin", options.begin,
                     fmt::format("beginning of the telemetry ({})", otherwise));
  command.add_option("--end", options.end, "end of the telemetry, which is not in it any more");
}

std::variant<storage::TimeRange, Refusal> range_of(const RangeOptions& options,
                                                   storage::TimeRange otherwise) {
  storage::TimeRange range = otherwise;
  if (auto refusal = read_telemetry_time("--begin", options.begin, range.begin)) return *refusal;
  if (auto refusal = read_telemetry_time("--end", options.end, range.end)) return *refusal;
  if (range.begin >= range.end)
    return Refusal{
        fmt::format("the telemetry would begin at {} and end at {}; give --begin and "
                    "--end so that it ends later",
                    time_text(range.begin), time_text(range.end))};
  return range;
}

}  // namespace reident::cli
