#include "service/telemetry_file/joined_blocks.hpp"

#include <fmt/format.h>

#include "service/support/text.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/clock_words.hpp"

namespace reident::telemetry_file {
namespace {

/// The last line that says something of a kind, and what.
struct Said {
  std::uint64_t line = 0;
  std::string what;
};

template <typename Find>
Said last_said(std::span<const NumberedLine> above, Find find) {
  Said said;
  for (const NumberedLine& line : above)
    if (std::string what = find(line.text); !what.empty()) said = {line.number, std::move(what)};
  return said;
}

/// A zone in a spelling that is one for the same offset.
std::string zone_of(std::string_view line) {
  const auto hint = zone_hint_of_line(line);
  if (!hint) return {};
  return hint->offset_ns ? fmt::format("offset {}", *hint->offset_ns) : hint->name;
}

std::string scale_of(std::string_view line) {
  return says_time_scale(line) ? time_scale_of(line, {}) : std::string();
}

}  // namespace

std::string spacecraft_of_line(std::string_view line) {
  line = line.substr(std::min(line.find_first_not_of("#%/!\" \t"), line.size()));
  const auto mark = line.find_first_of(":=;\t,");
  if (mark == std::string_view::npos) return {};
  const std::string_view key = trimmed(line.substr(0, mark));
  const bool may_be_weekday = line[mark] == ',' && key.size() == 3;  // Sat, 28 Feb 2024
  if (may_be_weekday || !is_named_like_a_spacecraft(key, false)) return {};
  std::string_view value = trimmed(line.substr(mark + 1));
  value = trimmed(value.substr(0, value.find_first_of(",;\t\"")));
  return std::string(value);
}

std::optional<std::string> said_otherwise(std::string_view line,
                                          std::span<const NumberedLine> above, bool of_lines) {
  const auto differs = [&](std::string_view what, const Said& first) {
    const std::string than = first.line == 0 ? "above the header nothing says one"
                                             : fmt::format("line {} says another one", first.line);
    return fmt::format(
        "{} says a {} of its own, as where files were joined, and {}; divide the file there",
        shown(trimmed(line)), what, than);
  };
  if (of_lines) {
    if (const std::string zone = zone_of(line); !zone.empty())
      if (const Said first = last_said(above, zone_of); first.what != zone)
        return differs("time zone", first);
    if (const std::string scale = scale_of(line); !scale.empty())
      if (const Said first = last_said(above, scale_of); first.what != scale)
        return differs("time scale", first);
  }
  if (const std::string spacecraft = spacecraft_of_line(line); !spacecraft.empty())
    if (const Said first = last_said(above, spacecraft_of_line);
        first.line != 0 && first.what != spacecraft)
      return differs("spacecraft", first);
  return std::nullopt;
}

}  // namespace reident::telemetry_file
