#include "service/telemetry_file/clock_names.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>

#include "service/support/text.hpp"
#include "service/telemetry_file/date_text.hpp"
#include "service/telemetry_file/name_words.hpp"
#include "service/telemetry_file/number_text.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t s = 1'000 * ms;

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

struct NamedDays {
  std::string_view name;
  std::int64_t epoch_ns;
};
/// Days since 2000 and 1950, as ESA counts them.
constexpr std::array<NamedDays, 2> named_days = {
    {{"mjd2000", 946'684'800'000'000'000}, {"mjd1950", -631'152'000'000'000'000}}};

/// A column of ephemeris time, as SPICE counts it; et means something else in other names.
bool is_ephemeris_time(std::string_view name) {
  const auto words = words_of(name);
  if (words.empty() || (words[0] != "et" && words[0] != "ephemeris")) return false;
  return std::all_of(words.begin() + 1, words.end(), [](const std::string& word) {
    return word == "time" || word == "j2000" || unit_of(word);
  });
}

/// The time that "2000-01-01T12:00:00 TDB" names, the time scale left out.
std::optional<DateText> read_epoch(std::string since) {
  for (const std::string_view scale : {"TDB", "TAI", "TT", "GPS"})
    if (const auto at = since.rfind(scale);
        at != std::string::npos && at + scale.size() == since.size())
      since = std::string(trimmed(std::string_view(since).substr(0, at)));
  const bool is_year =
      since.size() == 4 && since.find_first_not_of("0123456789") == std::string::npos;
  return read_date_text(since + (is_year ? "-01-01" : ""), DateOrder::year_first);
}

void note_epoch(std::string_view text, NameHint& hint) {
  std::string low;
  for (const char c : text) low += static_cast<char>(c >= 'A' && c <= 'Z' ? c | 0x20 : c);
  if (low.find("j2000") != std::string::npos) {
    hint.since = "J2000";
    return;
  }
  const auto at = low.find("since");
  if (at == std::string::npos) return;
  std::string since(text.substr(at + 5));
  since.erase(since.find_last_not_of(" )]_") + 1);
  since.erase(0, since.find_first_not_of(" _"));
  const auto date = read_epoch(since);
  if (date && date->has_date && !date->is_ordered)
    hint.epoch_ns = date->clock_ns - date->offset_ns.value_or(0);
  else if (since.find_first_of("0123456789") != std::string::npos) {
    hint.since = since;
  }
}

}  // namespace

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
  if (is_ephemeris_time(name)) hint.since = "J2000";
  for (const NamedDays& named : named_days)
    if (std::find(words.begin(), words.end(), named.name) != words.end()) {
      hint.epoch_ns = named.epoch_ns;
      hint.unit_ns = 86'400 * s;
    }
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
  if (all == "xvalue" || is_ephemeris_time(name)) return true;  // xvalue is of LabVIEW
  constexpr std::array<std::string_view, 13> hints = {
      "time",  "unix",  "date",    "utc",   "epoch",   "zeit",   "datum",
      "stamp", "since", "elapsed", "j2000", "mjd2000", "mjd1950"};
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
      {"msday", TimePart::millisecond_of_day},
      {"millisecondofday", TimePart::millisecond_of_day},
      {"millisecondsofday", TimePart::millisecond_of_day},
      {"cdsms", TimePart::millisecond_of_day},
      {"cdsday", TimePart::day},
      {"days", TimePart::day},
      {"daycount", TimePart::day},
      {"daynumber", TimePart::day},
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
