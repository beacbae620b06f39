// What of the telemetry is missing, and what screening did not believe.
#include <algorithm>
#include <map>

#include "service/web/disbelieved.hpp"
#include "service/web/questions.hpp"
#include "service/web/views.hpp"
#include "storage/care/completeness.hpp"

namespace reident::web {
namespace {

using storage::Time;
using storage::TimeRange;

constexpr std::int64_t usual_listed = 200, most_listed = 2000;
constexpr Time usual_range = 30 * 86'400 * storage::second_ns;

/// Where all telemetry ends, of whichever spacecraft.
Time newest_end(const std::vector<storage::SeriesInfo>& series) {
  Time end = storage::second_ns;
  for (const storage::SeriesInfo& one : series)
    if (one.origin == storage::Origin::real) end = std::max(end, one.last + 1);
  return end;
}

TimeRange newest_days(const std::vector<storage::SeriesInfo>& series) {
  const Time end = newest_end(series);
  return {end - usual_range, end};
}

/// Parameters of a spacecraft from which nothing came at about the same time.
struct Outage {
  TimeRange range;  // the widest of theirs
  std::vector<std::string> parameters;
};

/// Slow parameters come some seconds before and after the fast ones, on both sides of a gap.
bool are_one(const Outage& outage, TimeRange gap) {
  const Time slack = std::min(64 * storage::second_ns, (outage.range.end - outage.range.begin) / 4);
  return std::abs(outage.range.begin - gap.begin) <= slack &&
         std::abs(outage.range.end - gap.end) <= slack;
}

void add_gap(TimeRange gap, const std::string& parameter, std::multimap<Time, Outage>& outages) {
  constexpr Time reach = 64 * storage::second_ns;
  for (auto at = outages.lower_bound(gap.begin - reach);
       at != outages.end() && at->first <= gap.begin + reach; ++at) {
    if (!are_one(at->second, gap)) continue;
    at->second.range.begin = std::min(at->second.range.begin, gap.begin);
    at->second.range.end = std::max(at->second.range.end, gap.end);
    at->second.parameters.push_back(parameter);
    return;
  }
  outages.emplace(gap.begin, Outage{gap, {parameter}});
}

}  // namespace

Json gaps_view(const Stored& stored, const HttpRequest& request) {
  const auto series = stored.telemetry.series();
  const TimeRange range = range_of(request, newest_days(series));
  const auto listed =
      static_cast<std::size_t>(number_of(request, "rows", 1, most_listed, usual_listed));
  std::map<std::string, std::multimap<Time, Outage>> outages;
  std::map<std::string, std::size_t> parameters;
  // A spacecraft from which nothing comes any more is a gap as well.
  const Time until = std::min(range.end, newest_end(series) - 1);
  for (const storage::SeriesInfo& one : series) {
    if (one.origin != storage::Origin::real) continue;
    ++parameters[one.spacecraft];
    for (const TimeRange& gap : storage::gaps(stored.database, one, range, until))
      add_gap(gap, one.name, outages[one.spacecraft]);
    stored.check_time();
  }
  using Found = std::pair<std::string, Outage>;
  std::vector<Found> found;
  for (auto& [spacecraft, all] : outages)
    for (auto& [begin, outage] : all) found.emplace_back(spacecraft, std::move(outage));
  const std::size_t shown = std::min(found.size(), listed);
  const auto length = [](const Found& one) {
    return one.second.range.end - one.second.range.begin;
  };
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(shown), found.end(),
                    [&](const Found& a, const Found& b) { return length(a) > length(b); });
  Json list = Json::array();
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& [spacecraft, outage] = found[i];
    list.push_back({{"spacecraft", spacecraft},
                    {"begin", time_value(outage.range.begin)},
                    {"end", time_value(outage.range.end)},
                    {"seconds", static_cast<double>(length(found[i])) / 1e9},
                    {"parameters", outage.parameters},
                    {"of", parameters[spacecraft]}});
  }
  return {
      {"range", range_value(range)}, {"gaps", std::move(list)}, {"left_out", found.size() - shown}};
}

Json excluded_view(const Stored& stored, const HttpRequest& request) {
  constexpr Time pause = 3600 * storage::second_ns;  // spikes come again and again
  const TimeRange range = range_of(request, newest_days(stored.telemetry.series()));
  storage::RowFilter filter;
  filter.range = range;
  DisbelievedSensors sensors(pause);
  std::map<storage::EquipmentName, Time> screened_until;
  stored.registry.each_attempt(filter, [&](storage::Attempt&& attempt) {
    stored.check_time();
    Time& until = screened_until[{attempt.spacecraft, attempt.equipment}];
    until = std::max(until, attempt.window.end);
    sensors.add(attempt);
    return true;
  });
  const std::size_t left_out = sensors.left_out();
  Json list = Json::array();
  for (const Disbelieved& one : std::move(sensors).take()) {
    if (one.range.end <= range.begin || one.range.begin >= range.end) continue;
    const bool lasts = std::ranges::any_of(one.equipment, [&](const std::string& equipment) {
      return one.range.end >= screened_until[{one.spacecraft, equipment}];
    });
    list.push_back({{"spacecraft", one.spacecraft},
                    {"check", one.check},
                    {"relation", one.relation},
                    {"parameters", one.parameters},
                    {"begin", time_value(one.range.begin)},
                    {"end", time_value(one.range.end)},
                    {"lasts", lasts},
                    {"stretches", one.stretches},
                    {"residual", number_value(one.residual)},
                    {"tolerance", number_value(one.tolerance)},
                    {"equipment", one.equipment}});
  }
  return {{"range", range_value(range)}, {"excluded", std::move(list)}, {"left_out", left_out}};
}

}  // namespace reident::web
