#include "service/review/model_state.hpp"

#include <fmt/format.h>

#include "identification/simulation/initial_state.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/window_data.hpp"

namespace reident {

std::variant<ModelState, std::string> state_at(const storage::SampleReader& archive,
                                               const EquipmentModel& model, storage::Time time) {
  if (!is_well_formed(model)) return "the stored model is damaged";
  const identification::StateSpaceModel& dynamics = model.dynamics;
  const WindowRequest request = request_of(model);
  const auto loaded =
      load_window(archive, request, {time - identification::state_rows * request.period, time + 1});
  if (const auto* unknown = std::get_if<UnknownParameter>(&loaded))
    return fmt::format("the archive has no parameter {}", unknown->name);
  const identification::Record& record = std::get<WindowData>(loaded).record;
  const identification::Index needed = identification::initial_rows(dynamics);
  const identification::Segment last =
      record.segments.empty() ? identification::Segment{} : record.segments.back();
  if (last.size() < needed)
    return fmt::format(
        "the archive has {} rows without a hole before {}, and the state needs {}; name a time "
        "with more telemetry before it",
        last.size(), time_text(time), needed);
  ModelState state;
  state.x =
      identification::estimate_initial_state(dynamics, record, {last}, identification::state_rows);
  for (identification::Index row = last.begin; row + 1 < last.end; ++row)
    state.x = dynamics.A * state.x + dynamics.B * (record.u.row(row).transpose() - dynamics.u0);
  state.time = time_of_row(record, last.end - 1, request.period);
  return state;
}

}  // namespace reident
