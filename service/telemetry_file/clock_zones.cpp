#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/telemetry_file/clock_finder.hpp"
#include "service/telemetry_file/clock_words.hpp"

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
  for (const LineAbove& line : head_.above)
    if (const auto hint = zone_hint_of_line(line.text)) {
      const std::string where = "line " + std::to_string(line.number);
      take_zone(*hint, fmt::format("{} ({})", where, shown(trimmed(line.text))), "by " + where);
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
  for (const LineAbove& above : head_.above)
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

/// Numbers in a time scale that is no UTC, by their name.
std::optional<Problem> ClockFinder::refuse_scale_of_numbers(std::size_t c) const {
  const std::string scale = time_scale_of(head_.names[c], unit(c));
  if (options_.format || scale.empty() || scale == "GPS") return std::nullopt;
  const auto [cell, line] = first_cell(c);
  return Problem{
      line,
      fmt::format("{} in column '{}' is {} by the name, which is leap seconds "
                  "ahead of UTC; write UTC, or take it for UTC with --time-format unix, mjd or "
                  "what it is",
                  shown(cell), head_.names[c], scale)};
}

}  // namespace reident::telemetry_file
