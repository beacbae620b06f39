#include "service/telemetry_file/clock_names.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>

#include "service/support/text.hpp"
#include "service/telemetry_file/date_text.hpp"
#include "service/telemetry_file/number_text.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t s = 1'000 * ms;

/// "unix time [ms]" and "unixTimeMs" as unix, time, ms.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  char before = '\0';
  for (const char c : name) {
    const bool is_upper = c >= 'A' && c <= 'Z', is_lower = c >= 'a' && c <= 'z';
    const bool is_word = is_upper || is_lower || (c >= '0' && c <= '9') || (c & 0x80) != 0;
    const bool humps = is_upper && before >= 'a' && before <= 'z';
    if ((!is_word || humps) && !words.back().empty()) words.emplace_back();
    if (is_word) words.back() += static_cast<char>(is_upper ? c | 0x20 : c);
    before = c;
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::optional<std::int64_t> unit_of(const std::string& word) {
  static const std::map<std::string, std::int64_t> units = {{"ns", 1},
                                                            {"nsec", 1},
                                                            {"nanoseconds", 1},
                                                            {"us", 1000},
                                                            {"usec", 1000},
                                                            {"\xC2\xB5s", 1000},
                                                            {"microseconds", 1000},
                                                            {"ms", ms},
                                                            {"msec", ms},
                                                            {"millis", ms},
                                                            {"milliseconds", ms},
                                                            {"millisec", ms},
                                                            {"millisecond", ms},
                                                            {"micros", 1000},
                                                            {"microsecond", 1000},
                                                            {"s", s},
                                                            {"sec", s},
                                                            {"secs", s},
                                                            {"second", s},
                                                            {"seconds", s},
                                                            {"min", 60 * s},
                                                            {"minutes", 60 * s},
                                                            {"h", 3600 * s},
                                                            {"hours", 3600 * s},
                                                            {"d", 86400 * s},
                                                            {"days", 86400 * s},
                                                            {"mins", 60 * s},
                                                            {"minute", 60 * s},
                                                            {"hr", 3600 * s},
                                                            {"hrs", 3600 * s},
                                                            {"hour", 3600 * s},
                                                            {"day", 86400 * s},
                                                            {"week", 604800 * s},
                                                            {"weeks", 604800 * s},
                                                            {"microsec", 1000},
                                                            {"usecs", 1000},
                                                            {"msecs", ms},
                                                            {"nanosec", 1},
                                                            {"nsecs", 1},
                                                            {"nanosecs", 1},
                                                            {"nanos", 1}};
  const auto found = units.find(word);
  return found == units.end() ? std::nullopt : std::optional(found->second);
}

std::optional<TimeFormat> format_of(const std::string& word) {
  static const std::map<std::string, TimeFormat> formats = {
      {"mjd", TimeFormat::mjd},         {"jd", TimeFormat::jd},
      {"julian", TimeFormat::jd},       {"excel", TimeFormat::excel},
      {"serial", TimeFormat::excel},    {"filetime", TimeFormat::filetime},
      {"datenum", TimeFormat::matlab},  {"gps", TimeFormat::gps},
      {"gpst", TimeFormat::gps},        {"gnss", TimeFormat::gps},
      {"unix", TimeFormat::unix},       {"unixtime", TimeFormat::unix},
      {"posix", TimeFormat::unix},      {"met", TimeFormat::elapsed},
      {"elapsed", TimeFormat::elapsed}, {"mission", TimeFormat::elapsed},
      {"tow", TimeFormat::elapsed},     {"itow", TimeFormat::elapsed},
      {"uptime", TimeFormat::elapsed},  {"obt", TimeFormat::elapsed},
      {"scet", TimeFormat::elapsed},    {"sclk", TimeFormat::elapsed},
      {"cuc", TimeFormat::elapsed},     {"onboard", TimeFormat::elapsed},
      {"ticks", TimeFormat::dotnet}};
  const auto found = formats.find(word);
  return found == formats.end() ? std::nullopt : std::optional(found->second);
}

/// What stands in brackets at the end of a name.
std::string_view bracketed(std::string_view name) {
  name = trimmed(name);
  if (!name.ends_with(')') && !name.ends_with(']')) return {};
  const auto open = name.find_last_of("([");
  return open == std::string_view::npos ? std::string_view()
                                        : trimmed(name.substr(open + 1, name.size() - open - 2));
}

/// A short word that has to be a unit, or one with a number, and none that is known.
bool is_unknown_unit(std::string_view said) {
  constexpr std::size_t longest = 8;
  const auto words = words_of(said);
  if (words.empty() || words.size() > 2 || said.size() > longest || zone_hint_of({}, said))
    return false;
  if (words.size() == 2 && words[0].find_first_not_of("0123456789") != std::string::npos)
    return false;
  return words.size() == 2 || (!unit_of(words[0]) && !format_of(words[0]));
}

void note_epoch(std::string_view text, NameHint& hint) {
  std::string low;
  for (const char c : text) low += static_cast<char>(c >= 'A' && c <= 'Z' ? c | 0x20 : c);
  if (low.find("j2000") != std::string::npos) {
    hint.since = "J2000";
    hint.epoch = "2000-01-01T11:58:55.816Z";
    return;
  }
  const auto at = low.find("since");
  if (at == std::string::npos) return;
  std::string since(text.substr(at + 5));
  since.erase(since.find_last_not_of(" )]_") + 1);
  since.erase(0, since.find_first_not_of(" _"));
  const bool is_year =
      since.size() == 4 && since.find_first_not_of("0123456789") == std::string::npos;
  const auto date = read_date_text(since + (is_year ? "-01-01" : ""), DateOrder::year_first);
  if (date && date->has_date && !date->is_ordered)
    hint.epoch_ns = date->clock_ns - date->offset_ns.value_or(0);
  else if (since.find_first_of("0123456789") != std::string::npos) {
    hint.since = since;
    hint.epoch = "2000-01-01T00:00:00Z";
  }
}

/// Words that are a zone in any case: none is a word of another meaning, or a part of one.
bool is_zone_in_small_letters(std::string_view word) {
  constexpr std::string_view zones =
      " utc gmt cet cest mez mesz edt cst cdt mst mdt pst pdt jst kst ";
  return zones.find(" " + std::string(word) + " ") != std::string_view::npos;
}

std::optional<ZoneHint> zone_in(std::string_view text) {
  constexpr std::string_view ends = " \t_()[],;=:";
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find_first_of(ends, at), text.size());
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
  return ZoneHint{std::string(bracketed(rest)), -static_cast<std::int64_t>(*minutes) * 60 * s,
                  false};
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

std::optional<ZoneHint> zone_hint_of_line(std::string_view line) {
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
  if (is_of_zone || has({"local", "lokal", "lokale", "locale", "locales", "ortszeit"}))
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

std::optional<std::int64_t> fraction_of_second(std::string_view name, std::string_view seconds) {
  const auto words = words_of(name), others = words_of(seconds);
  const bool is_alone = words.size() == 1;
  const bool is_pair = words.size() > 1 && words.size() == others.size() &&
                       std::equal(words.begin(), words.end() - 1, others.begin()) &&
                       unit_of(others.back()) == s;
  const auto unit = is_alone || is_pair ? unit_of(words.back()) : std::nullopt;
  return unit && *unit < s ? unit : std::nullopt;
}

bool is_named_like_a_part_of_second(std::string_view name) {
  std::string all;
  for (const std::string& word : words_of(name)) all += word;
  constexpr std::array<std::string_view, 9> names = {
      "s", "sec", "second", "frac", "fraction", "fracsec", "subsec", "subsecond", "subseconds"};
  return std::find(names.begin(), names.end(), all) != names.end();
}

std::string time_scale_of(std::string_view name, std::string_view unit) {
  for (const std::string_view text : {unit, name})
    for (const std::string& word : words_of(text)) {
      if (word == "gps" || word == "gpst" || word == "gnss" || word == "gpstime") return "GPS";
      if (word == "tai" || word == "tai93") return "TAI";
      if (word == "tt" || word == "tdt") return "TT";
      if (word == "tdb") return "TDB";
    }
  return {};
}

bool says_time_scale(std::string_view line) {
  std::string all;
  for (const std::string& word : words_of(line)) all += word;
  constexpr std::array<std::string_view, 7> hints = {
      "timesystem", "timescale", "timereference", "zeitsystem", "zeitskala", "timesare", "timesin"};
  return std::any_of(hints.begin(), hints.end(),
                     [&](std::string_view hint) { return all.find(hint) != std::string::npos; });
}

bool counts_minutes(std::string_view name) {
  const std::string_view said = bracketed(name);
  return said == "mm:ss" || said == "m:ss" || said == "MM:SS" || said == "min:sec" ||
         said == "min:s";
}

bool is_day_of_year(std::string_view name) {
  std::string all;
  for (const std::string& word : words_of(name)) {
    if (word == "doy" || word == "ddd" || word == "yday") return true;
    all += word;
  }
  return all.find("dayofyear") != std::string::npos;
}

NameHint hint_of(std::string_view name, std::string_view unit) {
  NameHint hint;
  const auto words = words_of(name);
  for (const std::string& word : words)
    if (const auto format = format_of(word)) {
      // The time of a GPS week is no time since 1980.
      if (!hint.format || *format == TimeFormat::elapsed) hint.format = format;
    }
  constexpr std::size_t is_no_part = 4;  // letters of a unit that stands alone; day is of a date
  const auto since = std::find(words.begin(), words.end(), "since");
  if (since != words.begin() && since != words.end())
    hint.unit_ns = unit_of(*(since - 1));
  else if (words.size() > 1 || (!words.empty() && words.back().size() >= is_no_part))
    hint.unit_ns = unit_of(words.back());
  for (const std::string_view said : {bracketed(name), trimmed(unit)})
    if (is_unknown_unit(said)) hint.unknown_unit = said;
  for (const std::string_view text : {name, unit}) note_epoch(text, hint);
  if (hint.epoch_ns == 0) hint.epoch_ns.reset();  // as all that has no other epoch
  const TimePart part = part_of(name);
  const bool is_of_week = part == TimePart::week_second && words.back() == "week";
  if (part == TimePart::second_of_day || is_of_week)
    hint.unit_ns = s;
  else if (part == TimePart::millisecond_of_day)
    hint.unit_ns = ms;
  const auto unit_words = words_of(unit);
  if (!unit_words.empty()) {
    if (const auto said = unit_of(unit_words.front())) hint.unit_ns = said;
    if (const auto format = format_of(unit_words.front()); format && !hint.format)
      hint.format = format;
  }
  return hint;
}

bool is_named_like_a_spacecraft(std::string_view name, bool holds_numbers) {
  auto words = words_of(name);
  const bool is_id = words.size() > 1 && words.back() == "id";
  if (is_id || (words.size() > 1 && words.back() == "name")) words.pop_back();
  std::string all;
  for (const std::string& word : words) all += word;
  constexpr std::array<std::string_view, 5> ids = {"scid", "satid", "norad", "noradid", "noradcat"};
  constexpr std::array<std::string_view, 5> names = {"spacecraft", "satellite", "sat", "vehicle",
                                                     "satellit"};
  return std::find(ids.begin(), ids.end(), all) != ids.end() ||
         ((is_id || !holds_numbers) && std::find(names.begin(), names.end(), all) != names.end());
}

bool is_named_like_a_time(std::string_view name) {
  const auto words = words_of(name);
  std::string all;
  for (const std::string& word : words) {
    if (word == "t" || word == "mjd" || word == "jd" || word == "tow" || word == "met" ||
        word == "ts" || word == "gps" || word == "obt" || word == "scet") {
      if (&word == &words.front() || words.size() == 1) return true;
    }
    all += word;
  }
  if (all == "xvalue") return true;  // of LabVIEW
  constexpr std::array<std::string_view, 11> hints = {"time",  "unix",    "date",  "utc",
                                                      "epoch", "zeit",    "datum", "stamp",
                                                      "since", "elapsed", "j2000"};
  return std::any_of(hints.begin(), hints.end(),
                     [&](std::string_view hint) { return all.find(hint) != std::string::npos; });
}

bool are_named_alike(std::string_view name, std::string_view other) {
  const auto words = words_of(name), others = words_of(other);
  return std::find_first_of(words.begin(), words.end(), others.begin(), others.end()) !=
         words.end();
}

TimePart part_of(std::string_view name) {
  static const std::map<std::string, TimePart> parts = {
      {"year", TimePart::year},
      {"yyyy", TimePart::year},
      {"yr", TimePart::year},
      {"month", TimePart::month},
      {"mon", TimePart::month},
      {"day", TimePart::day},
      {"dayofmonth", TimePart::day},
      {"dd", TimePart::day},
      {"mm", TimePart::month},
      {"doy", TimePart::day_of_year},
      {"dayofyear", TimePart::day_of_year},
      {"ddd", TimePart::day_of_year},
      {"yday", TimePart::day_of_year},
      {"hour", TimePart::hour},
      {"hours", TimePart::hour},
      {"hh", TimePart::hour},
      {"hr", TimePart::hour},
      {"h", TimePart::hour},
      {"minute", TimePart::minute},
      {"mi", TimePart::minute},
      {"mn", TimePart::minute},
      {"min", TimePart::minute},
      {"minutes", TimePart::minute},
      {"m", TimePart::minute},
      {"second", TimePart::second},
      {"sec", TimePart::second},
      {"seconds", TimePart::second},
      {"ss", TimePart::second},
      {"s", TimePart::second},
      {"secofday", TimePart::second_of_day},
      {"secondofday", TimePart::second_of_day},
      {"secondsofday", TimePart::second_of_day},
      {"secsofday", TimePart::second_of_day},
      {"sod", TimePart::second_of_day},
      {"secday", TimePart::second_of_day},
      {"msofday", TimePart::millisecond_of_day},
      {"millisecofday", TimePart::millisecond_of_day},
      {"msod", TimePart::millisecond_of_day},
      {"date", TimePart::date},
      {"datum", TimePart::date},
      {"data", TimePart::date},
      {"fecha", TimePart::date},
      {"utcdate", TimePart::date},
      {"yyyyddd", TimePart::date},
      {"yyyydoy", TimePart::date},
      {"yyyymmdd", TimePart::date},
      {"dateutc", TimePart::date},
      {"time", TimePart::clock},
      {"clock", TimePart::clock},
      {"zeit", TimePart::clock},
      {"uhrzeit", TimePart::clock},
      {"heure", TimePart::clock},
      {"hora", TimePart::clock},
      {"ora", TimePart::clock},
      {"utc", TimePart::clock},
      {"utctime", TimePart::clock},
      {"timeutc", TimePart::clock},
      {"timeofday", TimePart::clock},
      {"hhmm", TimePart::clock},
      {"hhmmss", TimePart::clock},
      {"gpsweek", TimePart::gps_week},
      {"week", TimePart::gps_week},
      {"wn", TimePart::gps_week},
      {"weekno", TimePart::gps_week},
      {"tow", TimePart::week_second},
      {"tows", TimePart::week_second},
      {"towms", TimePart::week_second},
      {"itow", TimePart::week_second},
      {"gpstow", TimePart::week_second},
      {"sow", TimePart::week_second},
      {"gpssow", TimePart::week_second},
      {"secondofweek", TimePart::week_second},
      {"secondsofweek", TimePart::week_second},
      {"timeofweek", TimePart::week_second},
      {"gpsseconds", TimePart::week_second},
      {"secofweek", TimePart::week_second},
      {"gpssec", TimePart::week_second},
      {"gpss", TimePart::week_second},
      {"gpsms", TimePart::week_second},
      {"weekseconds", TimePart::week_second},
      {"weeksec", TimePart::week_second}};
  std::string all;
  for (const std::string& word : words_of(name)) all += word;
  const auto found = parts.find(all);
  return found == parts.end() ? TimePart::none : found->second;
}

}  // namespace reident::telemetry_file
