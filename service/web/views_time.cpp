#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "service/history/overview.hpp"
#include "service/history/summary.hpp"
#include "service/judgement/scores.hpp"
#include "service/review/model_run.hpp"
#include "service/web/disbelieved.hpp"
#include "service/web/questions.hpp"
#include "service/web/views.hpp"
#include "service/windows/block_reader.hpp"

namespace reident::web {
namespace {

using storage::EquipmentName;
using storage::Time;
using storage::TimeRange;

constexpr std::int64_t most_run_ticks = 400'000;

/// Seconds from the beginning of what is shown.
double seconds(Time time, Time begin) {
  return static_cast<double>(time - begin) / 1e9;
}

storage::Archive archive_of(const Stored& stored) {
  return storage::Archive(stored.database);
}

TimeRange extent_of(const Stored& stored, const std::string& spacecraft) {
  return archive_of(stored)
      .extent(spacecraft, storage::Origin::real)
      .value_or(TimeRange{0, storage::second_ns});
}

/// Least and greatest of each bin at their times, as columns.
class BinColumns {
 public:
  explicit BinColumns(Time begin) : begin_(begin) {}

  void add(Time least_time, double least, Time greatest_time, double greatest,
           std::uint64_t samples) {
    least_time_.push_back(seconds(least_time, begin_));
    greatest_time_.push_back(seconds(greatest_time, begin_));
    least_.push_back(number_value(least));
    greatest_.push_back(number_value(greatest));
    samples_.push_back(samples);
  }
  Json take() && {
    return {{"least_s", std::move(least_time_)},
            {"least", std::move(least_)},
            {"greatest_s", std::move(greatest_time_)},
            {"greatest", std::move(greatest_)},
            {"samples", std::move(samples_)}};
  }

 private:
  Time begin_;
  Json least_time_ = Json::array(), least_ = Json::array(), greatest_time_ = Json::array(),
       greatest_ = Json::array(), samples_ = Json::array();
};

/// A column of values on the grid, in bins.
template <typename Values>
Json column_in_bins(const identification::Record& record, storage::Time period,
                    const storage::TimeBins& bins, const Values& values) {
  BinColumns columns(bins.range().begin);
  struct Bin {
    std::size_t number = 0;
    Time least_time = 0, greatest_time = 0;
    double least = INFINITY, greatest = -INFINITY;
    std::uint64_t samples = 0;
  } bin;
  const auto finish = [&] {
    if (bin.samples > 0)
      columns.add(bin.least_time, bin.least, bin.greatest_time, bin.greatest, bin.samples);
  };
  for (const identification::Segment& segment : record.segments) {
    for (identification::Index row = segment.begin; row < segment.end; ++row) {
      const Time time = segment.tick_of(row) * period;
      const double value = values(row);
      if (!std::isfinite(value) || time < bins.range().begin || time >= bins.range().end) continue;
      if (const std::size_t number = bins.of(time); number != bin.number || bin.samples == 0) {
        finish();
        bin = {.number = number};
      }
      ++bin.samples;
      if (value < bin.least) {
        bin.least = value;
        bin.least_time = time;
      }
      if (value > bin.greatest) {
        bin.greatest = value;
        bin.greatest_time = time;
      }
    }
  }
  finish();
  return std::move(columns).take();
}

Json gaps_value(const std::vector<TimeRange>& gaps, Time begin) {
  Json list = Json::array();
  for (const TimeRange& gap : gaps)
    list.push_back({seconds(gap.begin, begin), seconds(gap.end, begin)});
  return list;
}

struct Reign {
  storage::Decision made;
  TimeRange range;
};

/// Who was champion on the axis of telemetry, and the decisions in the range.
std::vector<Reign> reigns_of(const Stored& stored, const EquipmentName& name, TimeRange range,
                             Json& events) {
  TelemetryClock clock(archive_of(stored).extent(name.spacecraft, storage::Origin::real));
  std::vector<Reign> reigns;
  for (const storage::Decision& decision : stored.history.decisions(name)) {
    const Time place = clock.place_of(decision);
    using Kind = storage::DecisionKind;
    const bool begins = decision.kind == Kind::approve || decision.kind == Kind::roll_back;
    const bool ends = decision.kind == Kind::withdraw && !reigns.empty() &&
                      reigns.back().made.version == decision.version;
    if (!reigns.empty() && (begins || ends) && reigns.back().range.end == INT64_MAX)
      reigns.back().range.end = place;
    if (begins) reigns.push_back({decision, {place, INT64_MAX}});
    if (place < range.begin || place >= range.end || decision.kind == Kind::wait) continue;
    events.push_back({{"at_s", seconds(place, range.begin)},
                      {"time", time_value(decision.time)},
                      {"kind", storage::name(decision.kind)},
                      {"version", id_value(decision.version)},
                      {"actor", decision.actor},
                      {"reason", decision.reason}});
  }
  std::erase_if(reigns, [range](const Reign& reign) {
    return reign.range.begin >= range.end || reign.range.end <= range.begin;
  });
  return reigns;
}

/// What screening left out of windows that meet the range; of each window the longest ones.
Json excluded_in(const std::vector<storage::Attempt>& attempts, TimeRange range) {
  DisbelievedSensors sensors(0);
  for (const storage::Attempt& attempt : attempts) sensors.add(attempt);
  Json list = Json::array();
  for (const Disbelieved& one : std::move(sensors).take())
    if (one.range.begin < range.end && one.range.end > range.begin)
      list.push_back({{"begin_s", seconds(one.range.begin, range.begin)},
                      {"end_s", seconds(one.range.end, range.begin)},
                      {"check", one.check},
                      {"parameters", one.parameters}});
  return list;
}

/// The errors of one champion's record: of a cycle at least, so that a block in which the outputs
/// hardly move does not look like a failure, and of as many blocks as lie in a bin.
Json record_in(const Stored& stored, const EquipmentName& name, const Reign& reign,
               const std::vector<storage::Block>& blocks, const storage::TimeBins& bins) {
  const Time begin = bins.range().begin;
  const std::vector<storage::BlockScore> scores = stored.registry.scores(
      name.spacecraft, name.equipment, reign.made.version, std::max(reign.range.begin, begin));
  using Scored = std::pair<const storage::Block*, const storage::BlockScore*>;
  std::vector<Scored> scored;
  const Time end = std::min(reign.range.end, bins.range().end);
  for (const storage::Block& block : blocks) {
    if (!counts(block) || block.range.begin < reign.range.begin || block.range.begin >= end)
      continue;
    if (const auto* score = find(scores, block.range.begin)) scored.emplace_back(&block, score);
  }
  Json from = Json::array(), to = Json::array(), error = Json::array(), simulator = Json::array();
  const auto bin_of = [&](std::size_t i) {
    return bins.of(std::max(scored[i].first->range.begin, begin));
  };
  for (std::size_t i = 0; i < scored.size();) {
    std::size_t next = i + 1;
    while (next < scored.size() && bin_of(next) == bin_of(i) &&
           scored[next].first->range.begin == scored[next - 1].first->range.end)
      ++next;
    constexpr std::size_t cycle = blocks_of_cycle;
    Sums own, rival;
    for (std::size_t k = std::min(i, next < cycle ? 0 : next - cycle); k < next; ++k) {
      own.add(*scored[k].first, scored[k].second->square);
      if (!scored[k].first->baseline_square.empty())
        rival.add(*scored[k].first, scored[k].first->baseline_square);
    }
    from.push_back(seconds(scored[i].first->range.begin, begin));
    to.push_back(seconds(scored[next - 1].first->range.end, begin));
    error.push_back(next < cycle ? Json() : number_value(own.mrse_percent()));
    simulator.push_back(next >= cycle && rival.rows > 0 ? number_value(rival.mrse_percent())
                                                        : Json());
    i = next;
  }
  return {{"version", id_value(reign.made.version)},
          {"from_s", std::move(from)},
          {"to_s", std::move(to)},
          {"error_percent", std::move(error)},
          {"simulator_percent", std::move(simulator)}};
}

}  // namespace

Json timeline_view(const Stored& stored, const HttpRequest& request) {
  const EquipmentName name = equipment_of(stored, request);
  const TimeRange range = range_of(request, extent_of(stored, name.spacecraft));
  const storage::TimeBins bins = bins_of(request, range);
  Json events = Json::array(), champions = Json::array(), records = Json::array();
  const auto reigns = reigns_of(stored, name, range, events);
  const auto blocks = stored.registry.blocks(name.spacecraft, name.equipment, range.begin);
  for (const Reign& reign : reigns) {
    const auto error = history::error_when_approved(stored.registry, reign.made);
    const Time begin = std::max(reign.range.begin, range.begin);
    const Time end = std::min(reign.range.end, range.end);
    champions.push_back({{"version", id_value(reign.made.version)},
                         {"begin_s", seconds(begin, range.begin)},
                         {"end_s", seconds(end, range.begin)},
                         {"approved_error_percent", error ? Json(*error) : Json()}});
    records.push_back(record_in(stored, name, reign, blocks, bins));
    stored.check_time();
  }
  storage::HistoryFilter filter;
  filter.spacecraft = name.spacecraft;
  filter.equipment = name.equipment;
  filter.window = range;
  constexpr std::size_t most_windows = 500;
  filter.last = most_windows;
  return {{"range", range_value(range)},
          {"bin_s", static_cast<double>(bins.length()) * 1e-9},
          {"champions", std::move(champions)},
          {"events", std::move(events)},
          {"records", std::move(records)},
          {"excluded", excluded_in(stored.history.attempts(filter), range)}};
}

Json telemetry_view(const Stored& stored, const HttpRequest& request) {
  const storage::SeriesInfo series = series_of(stored, request);
  const TimeRange range = range_of(request, {series.first, series.last + 1});
  const storage::TimeBins bins = bins_of(request, range);
  const auto summary = history::summarise(stored.database, series, bins, stored.pieces,
                                          [&stored] { stored.check_time(); });
  BinColumns columns(range.begin);
  Json flagged = Json::array();  // bins with samples that are not good
  for (const history::BinSummary& bin : summary.bins) {
    if (bin.numbers > 0)
      columns.add(bin.least_time, bin.least, bin.greatest_time, bin.greatest, bin.samples);
    if (bin.worst != storage::Quality::good)
      flagged.push_back({seconds(bin.first, range.begin), seconds(bin.last, range.begin),
                         storage::name(bin.worst)});
  }
  const auto described = stored.telemetry.parameter(series.spacecraft, series.name);
  Json view = {{"range", range_value(range)},
               {"bin_s", static_cast<double>(bins.length()) * 1e-9},
               {"unit", described ? described->unit : ""},
               {"low_limit", described ? number_value(described->low_limit) : Json()},
               {"high_limit", described ? number_value(described->high_limit) : Json()}};
  view.update(std::move(columns).take());
  view["flagged"] = std::move(flagged);
  view["gaps"] = gaps_value(summary.gaps, range.begin);
  return view;
}

Json run_view(const Stored& stored, const HttpRequest& request) {
  const EquipmentName name = equipment_of(stored, request);
  const TimeRange range = range_of(request, extent_of(stored, name.spacecraft));
  const storage::TimeBins bins = bins_of(request, range);
  const StoredVersion story = version_of(stored, name, request);
  const Duration period = request_of(story.model).period;
  if (period <= 0 || (range.end - range.begin) / period > most_run_ticks)
    throw BadRequest(
        fmt::format("a free run is drawn over at most {} samples, here {:.1f} days; "
                    "ask for a shorter range, or look at the record",
                    most_run_ticks, static_cast<double>(most_run_ticks * period) / 86400e9));
  const auto run = run_model(stored.telemetry, story.model, range, range.begin);
  if (const auto* reason = std::get_if<std::string>(&run)) throw BadRequest(*reason, 404);
  const auto& done = std::get<ModelRun>(run);
  Json outputs = Json::array();
  for (std::size_t i = 0; i < story.model.outputs.size(); ++i) {
    const auto column = static_cast<identification::Index>(i);
    const auto& record = done.data.record;
    outputs.push_back({{"name", story.model.outputs[i].name},
                       {"unit", story.model.outputs[i].unit},
                       {"run", column_in_bins(record, period, bins,
                                              [&](auto row) { return done.y_hat(row, column); })},
                       {"residual", column_in_bins(record, period, bins, [&](auto row) {
                          return record.y(row, column) - done.y_hat(row, column);
                        })}});
  }
  return {{"range", range_value(range)},
          {"bin_s", static_cast<double>(bins.length()) * 1e-9},
          {"version", id_value(story.version.number)},
          {"mrse_percent", number_value(done.score.mrse())},
          {"outputs", std::move(outputs)}};
}

}  // namespace reident::web
