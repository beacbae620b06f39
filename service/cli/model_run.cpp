#include "service/cli/model_run.hpp"

#include <fmt/format.h>

#include "identification/simulation/free_run.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::cli {
namespace {

// Years 1823 to 2116: differences of two such times fit in 64 bits.
constexpr storage::Time sane_time = (storage::Time{1} << 62) - 1;

std::optional<Refusal> read_time(std::string_view flag, const std::optional<std::string>& text,
                                 storage::Time& time) {
  if (!text) return std::nullopt;
  const auto parsed = parse_moment(*text, utc_now());
  if (!parsed || *parsed > sane_time || *parsed < -sane_time)
    return Refusal{
        fmt::format("{} {} is no time of the years 1823 to 2116; write it as "
                    "2025-01-31T12:00:00Z",
                    flag, *text)};
  time = *parsed;
  return std::nullopt;
}

identification::Index rows_before(const identification::Record& record, storage::Time time,
                                  Duration period) {
  identification::Index row = 0;
  while (row < record.rows() && time_of_row(record, row, period) < time) ++row;
  return row;
}

}  // namespace

void add_range_options(CLI::App& command, RangeOptions& options, const std::string& otherwise) {
  command.add_option("--begin", options.begin,
                     fmt::format("beginning of the telemetry ({})", otherwise));
  command.add_option("--end", options.end, "end of the telemetry, which is not in it any more");
}

std::variant<storage::TimeRange, Refusal> range_of(const RangeOptions& options,
                                                   storage::TimeRange otherwise) {
  storage::TimeRange range = otherwise;
  if (auto refusal = read_time("--begin", options.begin, range.begin)) return *refusal;
  if (auto refusal = read_time("--end", options.end, range.end)) return *refusal;
  if (range.begin >= range.end)
    return Refusal{
        fmt::format("the telemetry would begin at {} and end at {}; give --begin and "
                    "--end so that it ends later",
                    time_text(range.begin), time_text(range.end))};
  return range;
}

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

}  // namespace reident::cli
