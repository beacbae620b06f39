#include "service/review/model_run.hpp"

#include <fmt/format.h>

#include "identification/simulation/free_run.hpp"
#include "service/support/time_text.hpp"

namespace reident {
namespace {

identification::Index rows_before(const identification::Record& record, storage::Time time,
                                  Duration period) {
  return first_row_at(record, ticks_of({time, time}, period).begin);
}

}  // namespace

std::variant<ModelRun, std::string> run_model(const storage::SampleReader& archive,
                                              const EquipmentModel& model, storage::TimeRange range,
                                              storage::Time scored_from) {
  if (!is_well_formed(model.dynamics)) return "the stored model is damaged";
  const WindowRequest request = request_of(model);
  auto loaded = load_window(archive, request, range);
  if (const auto* unknown = std::get_if<UnknownParameter>(&loaded))
    return fmt::format("the archive has no parameter {}", unknown->name);
  ModelRun run;
  run.data = std::get<WindowData>(std::move(loaded));
  const identification::Index scored =
      run.data.record.rows() - rows_before(run.data.record, scored_from, request.period);
  if (scored == 0)
    return fmt::format("the archive has no row with every parameter valid from {} to {}",
                       time_text(scored_from), time_text(range.end));
  run.y_hat = free_run(model.dynamics, run.data.record, run.data.record.all());
  const identification::Record& record = run.data.record;
  const auto score = [&](const identification::Matrix& y_hat) {
    return identification::score(record.y.bottomRows(scored), y_hat.bottomRows(scored));
  };
  run.score = score(run.y_hat);
  if (model.tracking && is_stabilising(model.dynamics, model.tracking->gain)) {
    ModelRun::Tracked& tracked = run.tracked.emplace();
    tracked.y_hat = tracked_run(model.dynamics, model.tracking->gain, record, record.all());
    tracked.score = score(tracked.y_hat);
  }
  return run;
}

}  // namespace reident
