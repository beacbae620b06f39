#include "service/telemetry_file/clock_words.hpp"

#include <map>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {

std::string shown(std::string_view cell) {
  constexpr std::size_t longest = 40;
  return "'" + std::string(cell.substr(0, longest)) + "'";
}

std::string unit_name(std::int64_t unit_ns) {
  static const std::map<std::int64_t, std::string> names = {
      {1, "nanoseconds"},          {1000, "microseconds"},      {1'000'000, "milliseconds"},
      {second_ns, "seconds"},      {60 * second_ns, "minutes"}, {3600 * second_ns, "hours"},
      {86'400 * second_ns, "days"}};
  const auto found = names.find(unit_ns);
  return found == names.end() ? duration_text(unit_ns) : found->second;
}

std::string describe_format(TimeFormat format, std::int64_t unit_ns) {
  switch (format) {
    case TimeFormat::excel:
      return "days of a spreadsheet";
    case TimeFormat::mjd:
      return "modified Julian days";
    case TimeFormat::jd:
      return "Julian days";
    case TimeFormat::matlab:
      return "days of datenum";
    case TimeFormat::filetime:
      return "Windows file times";
    case TimeFormat::dotnet:
      return ".NET ticks";
    case TimeFormat::gps:
      return "GPS " + unit_name(unit_ns);
    case TimeFormat::unix:
      return unit_name(unit_ns) + " since 1970";
    case TimeFormat::elapsed:
      return "elapsed " + unit_name(unit_ns);
    case TimeFormat::mixed:
    case TimeFormat::text:
      break;
  }
  return "seconds since 1970 and dates";
}

std::string describe_text(std::string_view cell, DateOrder order, const DateText& text) {
  cell = trimmed(cell);
  if (!text.has_date) return "times of day";
  const auto digits_at = [&](std::size_t at) {
    return cell.size() > at && cell[at] >= '0' && cell[at] <= '9';
  };
  const bool year_first = digits_at(0) && digits_at(1) && digits_at(2) && digits_at(3);
  if (!year_first)
    return cell.find_first_of("/") == std::string_view::npos ? "dates"
           : order == DateOrder::day_first                   ? "dates, the day first"
                                                             : "dates, the month first";
  if (cell.find_first_of("Ww") == 5) return "ISO 8601, weeks";
  const bool ordinal =
      digits_at(5) && digits_at(6) && digits_at(7) && !digits_at(4) && !digits_at(8);
  const bool packed = digits_at(4) && digits_at(6) && !digits_at(7);
  if (ordinal || packed) return "day of year";
  return cell.size() > 4 && cell[4] == '-' ? "ISO 8601" : "dates, the year first";
}

}  // namespace reident::telemetry_file
