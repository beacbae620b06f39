#include <algorithm>

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/clock_finder.hpp"
#include "service/telemetry_file/clock_words.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {

using Problem = Clock::Problem;

/// The zone that the name of a column says, as "Zeit (MEZ)".
void ClockFinder::take_zone_of_names() {
  for (const std::size_t c : clock_.columns_) {
    auto hint = zone_hint_of(head_.names[c], unit(c));
    if (const std::string zone = unknown_zone_of(head_.names[c], unit(c)); !hint && !zone.empty())
      hint = ZoneHint{zone, {}, true};
    if (!hint) continue;
    take_zone(*hint, "column '" + head_.names[c] + "'", "by the name");
    if (!hint->is_local) return;
  }
}

/// The zone that a line above the header says, as "Timezone;Europe/Berlin".
void ClockFinder::take_zone_of_lines() {
  for (const NumberedLine& line : head_.above)
    if (const auto hint = zone_hint_of_line(line.text)) {
      const std::string where = "line " + std::to_string(line.number);
      take_zone(*hint, fmt::format("{} ({})", where, shown(trimmed(line.text))), "by " + where);
      clock_.is_zone_of_lines_ = true;
    }
}

void ClockFinder::take_zone(const ZoneHint& hint, const std::string& where,
                            std::string_view evidence) {
  if (hint.is_local) {
    clock_.local_by_ = where;
    return;
  }
  clock_.local_by_.clear();
  clock_.may_be_local_ = false;
  if (hint.offset_ns)
    clock_.offset_ns_ = hint.offset_ns;
  else
    clock_.zone_ = TimeZone::named(hint.name);
  if (hint.offset_ns != 0) clock_.description_ += fmt::format(", {} {}", hint.name, evidence);
}

/// Dates of GPS and TAI are ahead of UTC by leap seconds; some receivers write UTC as GPS time.
std::optional<Problem> ClockFinder::decide_scale(std::size_t c) {
  clock_.is_gps_date_ = options_.format == TimeFormat::gps;
  if (options_.format) return std::nullopt;
  std::string scale = time_scale_of(head_.names[c], unit(c));
  auto [cell, line] = first_cell(c);
  std::string where = "by the name of column '" + head_.names[c] + "'";
  for (const NumberedLine& above : head_.above)
    if (scale.empty() && says_time_scale(above.text)) {
      scale = time_scale_of(above.text, {});
      where = fmt::format("by line {} ({})", above.number, shown(trimmed(above.text)));
    }
  if (scale.empty()) return std::nullopt;
  return Problem{
      line, scale == "GPS"
                ? fmt::format("{} may be GPS time {}, which is leap seconds ahead of UTC; say "
                              "--time-format gps, which takes them out, or iso for UTC",
                              shown(cell), where)
                : fmt::format("{} is {} {}, which is more than half a minute ahead of UTC; write "
                              "UTC, or take the dates for UTC with --time-format iso",
                              shown(cell), scale, where)};
}

/// The epoch of numbers in a time scale, as UTC would have to count from it to be right at the time
/// of `value`: leap seconds since then are left out.
std::string ClockFinder::epoch_in_utc(std::string_view scale, const NameHint& hint,
                                      double value) const {
  const std::int64_t epoch_ns = hint.epoch_ns.value_or(j2000_ns);
  const double unit_ns =
      static_cast<double>(options_.unit_ns.value_or(hint.unit_ns.value_or(second_ns)));
  constexpr double latest_ns = 4e18;  // far within 64 bits
  const double at_ns = static_cast<double>(epoch_ns) + value * unit_ns;
  const auto at = static_cast<std::int64_t>(std::clamp(at_ns, -latest_ns, latest_ns));
  return time_text(epoch_ns - ahead_of_utc(scale, at));
}

/// Numbers in a time scale that is no UTC, by their name.
std::optional<Problem> ClockFinder::refuse_scale_of_numbers(std::size_t c, const NameHint& hint,
                                                            double value) const {
  const std::string scale = time_scale_of(head_.names[c], unit(c));
  const bool has_epoch = hint.epoch_ns || hint.since == "J2000";
  const bool is_gps = scale == "GPS" && (!has_epoch || hint.epoch_ns == gps_epoch_ns);
  if (options_.format || options_.epoch_ns || scale.empty() || is_gps) return std::nullopt;
  const auto [cell, line] = first_cell(c);
  const std::string what = fmt::format(
      "{} in column '{}' is {} by the name, which is leap seconds "
      "ahead of UTC; ",
      shown(cell), head_.names[c], scale);
  if (has_epoch)
    return Problem{line, what + "say --epoch " + epoch_in_utc(scale, hint, value) +
                             ", which takes out those of the first row"};
  return Problem{line, what +
                           "write UTC, or take it for UTC with --time-format unix, mjd or what "
                           "it is, or with --epoch"};
}

}  // namespace reident::telemetry_file
