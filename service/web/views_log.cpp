#include <algorithm>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "service/web/questions.hpp"
#include "service/web/views.hpp"

namespace reident::web {
namespace {

constexpr storage::Time day = 86'400 * storage::second_ns;
constexpr std::int64_t usual_rows = 100, most_rows = 1000, most_days = 4000;

/// The kinds of decisions that `kind` names, with commas between them; none: all.
std::vector<storage::DecisionKind> kinds_of(const HttpRequest& request) {
  std::vector<storage::DecisionKind> kinds;
  std::string_view rest = request.parameter("kind");
  while (!rest.empty()) {
    const std::string_view word = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(word.size() + 1, rest.size()));
    const auto kind = storage::decision_kind(word);
    if (!kind)
      throw BadRequest(
          fmt::format("there is no kind {:.40} of decisions; there are approve, reject, "
                      "wait, roll_back and withdraw",
                      word));
    kinds.push_back(*kind);
  }
  return kinds;
}

}  // namespace

Json events_view(const Stored& stored, const HttpRequest& request) {
  storage::RowFilter filter;
  filter.spacecraft = request.parameter("spacecraft");
  filter.equipment = request.parameter("equipment");
  if (!request.parameter("begin").empty() || !request.parameter("end").empty())
    filter.range = range_of(request, {INT64_MIN / 2, INT64_MAX / 2});
  filter.newest_first = true;
  if (const auto before = number_of(request, "before", 1, INT64_MAX, 0)) filter.beyond = before;
  const auto kinds = kinds_of(request);
  const auto actor = request.parameter("by");  // "gate", "operator", or a name
  const auto rows = static_cast<std::size_t>(number_of(request, "rows", 1, most_rows, usual_rows));
  Json list = Json::array(), next;
  stored.registry.each_decision(filter, [&](storage::Decision&& decision) {
    const bool is_gate = decision.actor == "gate";
    if ((!kinds.empty() && !std::ranges::count(kinds, decision.kind)) ||
        (!actor.empty() && decision.actor != actor && (actor != "operator" || is_gate)))
      return true;
    if (list.size() == rows) {
      next = list.back()["id"];
      return false;
    }
    list.push_back({{"id", id_value(decision.id)},
                    {"time", time_value(decision.time)},
                    {"spacecraft", decision.spacecraft},
                    {"equipment", decision.equipment},
                    {"kind", storage::name(decision.kind)},
                    {"version", id_value(decision.version)},
                    {"actor", decision.actor},
                    {"reason", decision.reason}});
    return true;
  });
  return {{"events", std::move(list)}, {"before", std::move(next)}};
}

Json commands_view(const Stored& stored, const HttpRequest& request) {
  const auto rows = static_cast<std::size_t>(number_of(request, "rows", 1, most_rows, usual_rows));
  const auto range = range_of(request, {INT64_MIN / 2, INT64_MAX / 2});
  Json list = Json::array();
  auto kept = stored.registry.commands(range, rows + 1);
  const bool is_cut = kept.size() > rows;
  if (is_cut) kept.pop_back();
  for (const auto& [command, time, outcome] : kept)
    list.push_back({{"time", time_value(time)},
                    {"action", command.action},
                    {"spacecraft", command.spacecraft},
                    {"equipment", command.equipment},
                    {"version", command.version > 0 ? id_value(command.version) : Json()},
                    {"actor", command.actor},
                    {"reason", command.reason},
                    {"ok", outcome.ok},
                    {"reply", outcome.reply}});
  return {{"commands", std::move(list)}, {"is_cut", is_cut}};
}

Json series_view(const Stored& stored, const HttpRequest&) {
  Json list = Json::array();
  for (const storage::SeriesInfo& one : stored.telemetry.series())
    list.push_back({{"spacecraft", one.spacecraft},
                    {"parameter", one.name},
                    {"origin", storage::name(one.origin)},
                    {"samples", one.samples},
                    {"first", time_value(one.first)},
                    {"last", time_value(one.last)}});
  return {{"series", std::move(list)}};
}

Json completeness_view(const Stored& stored, const HttpRequest& request) {
  const storage::SeriesInfo series = series_of(stored, request);
  const storage::TimeRange range = range_of(request, {series.first, series.last + 1});
  if ((range.end - range.begin) / day > most_days)
    throw BadRequest(
        fmt::format("completeness is shown for at most {} days; ask for fewer", most_days));
  const storage::TimeBins bins(range, day);
  const auto extent = storage::Archive(stored.database).extent(series.spacecraft, series.origin);
  const auto counts =
      stored.telemetry.completeness(series, bins, extent ? extent->end - 1 : series.last);
  Json begin = Json::array(), came = Json::array(), missing = Json::array(), gaps = Json::array(),
       longest = Json::array();
  for (std::size_t i = 0; i < counts.size(); ++i) {
    begin.push_back(time_value(bins.at(i).begin));
    came.push_back(counts[i].came);
    missing.push_back(counts[i].missing);
    gaps.push_back(counts[i].gaps);
    longest.push_back(static_cast<double>(counts[i].longest_gap) * 1e-9);
  }
  return {{"begin", std::move(begin)},
          {"came", std::move(came)},
          {"missing", std::move(missing)},
          {"gaps", std::move(gaps)},
          {"longest_gap_s", std::move(longest)}};
}

}  // namespace reident::web
