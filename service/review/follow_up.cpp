#include "service/review/follow_up.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "identification/fit/static_regression.hpp"
#include "identification/simulation/free_run.hpp"
#include "service/history/telemetry_champion.hpp"
#include "service/model/model_json.hpp"
#include "service/review/model_run.hpp"

namespace reident {
namespace {

using history::Tenure;
using identification::Matrix;
using identification::Record;
using identification::score;
using identification::Score;

/// Behind the last sample of the equipment's first output.
storage::Time end_of(const std::vector<storage::SeriesInfo>& all, const EquipmentModel& model) {
  for (const storage::SeriesInfo& series : all)
    if (series.spacecraft == model.spacecraft && series.origin == storage::Origin::real &&
        series.name == model.outputs.front().name)
      return series.last + 1;
  return 0;
}

class Follower {
 public:
  Follower(const history::HistoryReader& history, const history::TelemetryReader& telemetry,
           const storage::EquipmentName& equipment)
      : history_(history),
        telemetry_(telemetry),
        equipment_(equipment),
        series_(telemetry.series()) {}

  FollowUp follow(const Tenure& tenure, std::int64_t replaced, storage::Time until) const {
    FollowUp found;
    found.version = tenure.version;
    found.replaced = replaced;
    found.range = {tenure.from, until};
    found.reason = fill(found);
    return found;
  }

 private:
  /// Returns why there are no errors.
  std::string fill(FollowUp& found) const {
    const auto version = history_.version(equipment_, found.version);
    if (!version) return "the version is gone";
    const EquipmentModel model = equipment_model_from_json(version->model_json);
    found.range.end = std::min(found.range.end, end_of(series_, model));
    if (found.range.end <= found.range.begin) return "no telemetry follows it";
    const storage::TimeRange run{version->window.begin, found.range.end};
    const auto ran = run_model(telemetry_, model, run, found.range.begin);
    if (const auto* reason = std::get_if<std::string>(&ran)) return *reason;
    const auto& [data, y_hat, own, tracked] = std::get<ModelRun>(ran);
    found.own = own;
    const Record& record = data.record;
    const Matrix y = record.y.bottomRows(own.rows);
    if (found.replaced != 0) {
      if (const auto before = history_.version(equipment_, found.replaced)) {
        const EquipmentModel other = equipment_model_from_json(before->model_json);
        if (is_well_formed(other.dynamics) && request_of(other) == request_of(model))
          found.before =
              score(y, free_run(other.dynamics, record, record.all()).bottomRows(own.rows));
      }
    }
    const identification::Index fitted =  // rows of its window
        first_row_at(record, ticks_of(version->window, request_of(model).period).end);
    if (fitted == 0) return "the telemetry of its window is gone";
    const auto mean = record.y.topRows(fitted).colwise().mean();
    found.mean = score(y, mean.replicate(own.rows, 1));
    const auto regression = static_regression(record, {0, fitted});
    found.static_regression =
        score(y, free_run(regression, record, record.all()).bottomRows(own.rows));
    return {};
  }

  const history::HistoryReader& history_;
  const history::TelemetryReader& telemetry_;
  const storage::EquipmentName& equipment_;
  const std::vector<storage::SeriesInfo> series_;
};

}  // namespace

std::vector<FollowUp> follow_up(const history::HistoryReader& history,
                                const history::TelemetryReader& telemetry,
                                const storage::EquipmentName& equipment, Duration span) {
  const std::vector<Tenure> tenures = history::tenures(history, equipment);
  if (tenures.empty()) return {};
  const Follower follower(history, telemetry, equipment);
  std::vector<FollowUp> all;
  for (std::size_t i = 0; i < tenures.size(); ++i) {
    const Tenure& one = tenures[i];
    if (one.version == 0) continue;
    const storage::Time next = i + 1 < tenures.size() ? tenures[i + 1].from : INT64_MAX;
    all.push_back(
        follower.follow(one, i > 0 ? tenures[i - 1].version : 0, std::min(next, one.from + span)));
  }
  return all;
}

}  // namespace reident
