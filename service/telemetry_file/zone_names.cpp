#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "service/support/text.hpp"
#include "service/telemetry_file/clock_names.hpp"
#include "service/telemetry_file/date_text.hpp"
#include "service/telemetry_file/name_words.hpp"
#include "service/telemetry_file/number_text.hpp"
#include "service/telemetry_file/time_units.hpp"

namespace reident::telemetry_file {
namespace {

/// Words that are a zone in any case: none is a word of another meaning, or a part of one.
bool is_zone_in_small_letters(std::string_view word) {
  constexpr std::string_view zones =
      " utc gmt cet cest mez mesz edt cst cdt mst mdt pst pdt jst kst ";
  return zones.find(" " + std::string(word) + " ") != std::string_view::npos;
}

std::optional<ZoneHint> zone_in(std::string_view text) {
  constexpr std::string_view ends = " \t_()[],;=:";
  const auto is_digit = [&](std::size_t at) {
    return at < text.size() && text[at] >= '0' && text[at] <= '9';
  };
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = std::min(text.find_first_of(ends, at), text.size());
    if (end > 0 && end < text.size() && text[end] == ':' && is_digit(end - 1) && is_digit(end + 1))
      end = std::min(text.find_first_of(ends, end + 1), text.size());  // UTC+05:30
    const std::string word(text.substr(at, end - at));
    at = end + 1;
    if (word.find('/') != std::string::npos && TimeZone::named(word))
      return ZoneHint{word, {}, false};
    const bool is_name = word.size() >= 3 && word[0] >= 'A' && word[0] <= 'Z' && word[1] >= 'A' &&
                         word[1] <= 'Z' && word != "MET";  // mission elapsed time
    const bool is_small = is_zone_in_small_letters(word);
    const auto offset = is_name || is_small ? read_offset(word) : std::nullopt;
    if (offset) return ZoneHint{word, offset, false};
    const auto slash = word.find('/');  // Zeit/MEZ
    if (slash != std::string::npos)
      if (auto zone = zone_in(std::string_view(word).substr(slash + 1))) return zone;
  }
  return std::nullopt;
}

/// The zone of "(PDH-CSV 4.0) (W. Europe Standard Time)(-60)", in minutes west of UTC.
std::optional<ZoneHint> zone_of_windows_counters(std::string_view name) {
  const auto minutes = plain_number(bracketed(name));
  if (!name.starts_with("(PDH-CSV") || !minutes || std::abs(*minutes) > 24 * 60)
    return std::nullopt;
  const std::string_view rest = name.substr(0, name.find_last_of('('));
  return ZoneHint{std::string(bracketed(rest)), -static_cast<std::int64_t>(*minutes) * minute_ns,
                  false};
}

/// Whether a line names a zone as Windows does, "(UTC+01:00) Berlin", which has daylight saving
/// that the offset leaves out.
bool is_zone_of_windows(std::string_view line) {
  for (const std::string_view begin : {"(UTC+", "(UTC-", "(GMT+", "(GMT-"})
    if (const auto open = line.find(begin); open != std::string_view::npos) {
      const std::string_view rest = line.substr(std::min(line.find(')', open), line.size()));
      const auto first = rest.find_first_not_of(") ");
      return first != std::string_view::npos && ((rest[first] | 0x20) >= 'a') &&
             ((rest[first] | 0x20) <= 'z');
    }
  return false;
}

/// The zone that a line is and nothing else, as "GMT+2".
std::optional<ZoneHint> zone_alone(std::string_view line) {
  constexpr std::string_view around = "#%/!\"',;: \t";
  const auto first = line.find_first_not_of(around);
  if (first == std::string_view::npos) return std::nullopt;
  line = line.substr(first, line.find_last_not_of(around) + 1 - first);
  if (line.starts_with("(UTC") || line.starts_with("(GMT"))
    line = line.substr(1, std::min(line.find(')'), line.size()) - 1);
  constexpr std::string_view other_words = " MET WET WEST ART ";  // directions, states of a test
  const bool is_word = other_words.find(" " + std::string(line) + " ") == std::string_view::npos;
  if (!is_word || line.find_first_of(" \t,;") != std::string_view::npos) return std::nullopt;
  return zone_in(line);
}

}  // namespace

std::optional<ZoneHint> zone_hint_of(std::string_view name, std::string_view unit) {
  if (auto zone = zone_of_windows_counters(name)) return zone;
  for (const std::string_view text : {unit, name})
    if (auto zone = zone_in(text)) return zone;
  for (const std::string_view text : {unit, name})
    for (const std::string& word : words_of(text))
      if (word == "local" || word == "localtime" || word == "lokal" || word == "lokalzeit" ||
          word == "ortszeit" || word == "locale" || word == "locais" ||
          word ==
              "\xE5\x8C\x97\xE4\xBA\xAC"
              "\xE6\x97\xB6\xE9\x97\xB4")
        return ZoneHint{word, {}, true};
  for (const std::string_view said : {trimmed(unit), bracketed(name)})
    if (said.starts_with('+') || said.starts_with('-'))
      if (const auto offset = read_offset(said)) return ZoneHint{std::string(said), offset, false};
  return std::nullopt;
}

std::string unknown_zone_of(std::string_view name, std::string_view unit) {
  constexpr std::string_view others =
      " ISO MJD MET UT1 TAI GPS GPST GNSS TDB TDT UNIX POSIX SCET OBT SCLK CUC CDS DOY EPOCH DATE "
      "TIME ";
  for (const std::string_view said : {trimmed(unit), bracketed(name)}) {
    const bool is_short = said.size() >= 3 && said.size() <= 5 &&
                          said.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") == said.npos;
    if (said.starts_with("UTC")) continue;
    if (is_short ? others.find(" " + std::string(said) + " ") == others.npos
                 : said.ends_with(" Time"))
      return std::string(said);
  }
  return {};
}

bool is_zone_key(std::string_view name) {
  const auto words = words_of(name);
  return is_named_like_a_zone(name) || (words.size() == 1 && words[0] == "zone");
}

std::optional<ZoneHint> zone_hint_of_line(std::string_view line) {
  if (is_zone_of_windows(line)) return ZoneHint{std::string(trimmed(line)), {}, true};
  if (auto zone = zone_alone(line)) return zone;
  const auto words = words_of(line);
  const auto has = [&](std::initializer_list<std::string_view> any) {
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
      return std::find(any.begin(), any.end(), word) != any.end();
    });
  };
  const bool is_of_zone = is_named_like_a_zone(line);
  const bool is_of_times = has({"times", "timestamps", "zeiten", "zeitstempel", "zeitangaben",
                                "heures", "horas", "zone"}) ||
                           (has({"time", "zeit"}) && has({"local", "lokale", "ortszeit"}));
  const bool is_offset = has({"offset"});
  if (!is_of_zone && !is_of_times) return std::nullopt;
  if (auto zone = zone_in(line); zone && !is_offset) return zone;
  const auto sign = line.find_first_of("+-");
  if (is_of_zone && sign != std::string_view::npos) {
    const std::string_view said = line.substr(sign, line.find_first_of(" \t,;)]\"", sign) - sign);
    if (const auto offset = read_offset(said)) return ZoneHint{std::string(said), offset, false};
  }
  std::string_view last = line.substr(0, line.find_last_not_of("\",; \t") + 1);
  last = last.substr(last.find_last_of(":=,;\t ") + 1);
  const bool is_key = words.size() > 1 && words[0] == "zone" && !unknown_zone_of({}, last).empty();
  if (is_of_zone || is_key || has({"local", "lokal", "lokale", "locale", "locales", "ortszeit"}))
    return ZoneHint{std::string(trimmed(line)), {}, true};
  return std::nullopt;
}

bool is_named_like_a_zone(std::string_view name) {
  std::string all;
  for (const std::string& word : words_of(name)) {
    if (word == "tz") return true;
    all += word;
  }
  constexpr std::array<std::string_view, 8> hints = {
      "timezone", "zeitzone",      "utcoffset",   "gmtoffset",
      "tzoffset", "fuseauhoraire", "zonahoraria", "fusohor\xC3\xA1rio"};
  return std::any_of(hints.begin(), hints.end(),
                     [&](std::string_view hint) { return all.find(hint) != std::string::npos; });
}

}  // namespace reident::telemetry_file
