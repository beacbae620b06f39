#include "service/daemon/refresh.hpp"

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "identification/identify.hpp"
#include "service/daemon/window_data.hpp"
#include "service/model/diagnostics_json.hpp"
#include "service/model/model_json.hpp"
#include "service/support/floor_divide.hpp"
#include "service/support/phase_timer.hpp"
#include "service/support/version.hpp"

namespace reident {
namespace {

using identification::Identified;
using identification::Matrix;
using identification::RowRange;
using nlohmann::ordered_json;

std::vector<Signal> signals(const std::vector<storage::ParameterDescriptor>& descriptors,
                            const Matrix& samples) {
  std::vector<Signal> result;
  result.reserve(descriptors.size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const auto column = samples.col(static_cast<Eigen::Index>(i));
    result.push_back(
        {descriptors[i].name, descriptors[i].unit, column.minCoeff(), column.maxCoeff()});
  }
  return result;
}

/// The rows that identify and, after them, the rows that validate.
struct Split {
  RowRange identify, validate;
};

Split split_rows(const identification::Record& record, double validation_share) {
  const auto rows = record.rows();
  const auto validated =
      static_cast<Eigen::Index>(std::llround(static_cast<double>(rows) * validation_share));
  return {{0, rows - validated}, {rows - validated, rows}};
}

storage::TimeRange time_range(const identification::Record& record, RowRange rows,
                              Duration period) {
  if (rows.size() == 0) return {};
  return {time_of_row(record, rows.begin, period),
          time_of_row(record, rows.end - 1, period) + period};
}

double residual_over_span(const Matrix& y, const Matrix& y_hat, const Matrix& window_y) {
  double worst = 0;
  for (Eigen::Index q = 0; q < y.cols(); ++q) {
    const double span = window_y.col(q).maxCoeff() - window_y.col(q).minCoeff();
    const double error = (y.col(q) - y_hat.col(q)).cwiseAbs().maxCoeff();
    worst = std::max(worst, error / span);
  }
  return worst;
}

bool every_column_moves(const Matrix& samples) {
  return (samples.colwise().maxCoeff().array() > samples.colwise().minCoeff().array()).all();
}

/// The champion's error on the stretch of time that validates the candidate. NaN where telemetry
/// does not allow to run it there.
double champion_mrse(const storage::Archive& archive, const EquipmentModel& champion,
                     const WindowRequest& loaded, const WindowData& data, storage::TimeRange window,
                     storage::TimeRange validation) {
  const WindowRequest request = request_of(champion);
  WindowData own;
  const WindowData* source = &data;
  if (request != loaded) {
    auto result = load_window(archive, request, window);
    if (!std::holds_alternative<WindowData>(result))
      return std::numeric_limits<double>::quiet_NaN();
    own = std::get<WindowData>(std::move(result));
    source = &own;
  }
  const identification::Record& record = source->record;
  const RowRange scored{
      first_row_at(record, floor_divide(validation.begin + request.period - 1, request.period)),
      first_row_at(record, floor_divide(validation.end + request.period - 1, request.period))};
  if (scored.size() == 0) return std::numeric_limits<double>::quiet_NaN();
  return score_free_run(champion.dynamics, record, record.all(), scored).mrse();
}

std::optional<Evidence::Champion> champion_evidence(const storage::Archive& archive,
                                                    const storage::Registry& registry,
                                                    const RefreshRequest& request,
                                                    const WindowRequest& loaded,
                                                    const WindowData& data,
                                                    storage::TimeRange validation) {
  const auto version = registry.champion(request.spacecraft, request.equipment.name);
  if (!version) return std::nullopt;
  Evidence::Champion champion{version->number, std::numeric_limits<double>::quiet_NaN(),
                              version->window.end};
  try {
    const EquipmentModel model = equipment_model_from_json(version->model_json);
    if (signal_names(model.outputs) != request.equipment.outputs) return std::nullopt;
    champion.mrse_percent = champion_mrse(archive, model, loaded, data, request.window, validation);
  } catch (const std::invalid_argument&) {
    // Damaged in the registry: it cannot be published either, and any good candidate replaces it.
  }
  return champion;
}

std::string method_text(const identification::Recipe& recipe) {
  std::string text =
      fmt::format("{}, horizon {}, order {}", name(recipe.weighting), recipe.horizon, recipe.order);
  if (recipe.fit == identification::ResponseFit::subspace) text += ", B and D of the compression";
  if (recipe.refinement_steps > 0) text += ", refined";
  if (recipe.stability == identification::Stability::enforced) text += ", A made stable";
  return text;
}

EquipmentModel candidate_model(const RefreshRequest& request, const WindowData& data,
                               const Identified& identified, const Split& split) {
  const Duration period = request.equipment.sample_period;
  EquipmentModel model;
  model.spacecraft = request.spacecraft;
  model.equipment = request.equipment.name;
  const auto identify_rows = [&](const Matrix& samples) {
    return samples.middleRows(split.identify.begin, split.identify.size());
  };
  model.inputs = signals(data.inputs, identify_rows(data.record.u));
  model.outputs = signals(data.outputs, identify_rows(data.record.y));
  model.dynamics = identified.model;
  model.hold_ns = request.equipment.hold;
  model.identified_from = time_range(data.record, split.identify, period);
  model.validated_on = time_range(data.record, split.validate, period);
  model.method = method_text(identified.recipe);
  return model;
}

ordered_json evidence_json(const RefreshResult& result, const Identified& identified,
                           const WindowData& data, const Split& split) {
  const EquipmentModel& model = *result.candidate;
  ordered_json json;
  json["order"] = model.dynamics.order();
  json["horizon"] = identified.recipe.horizon;
  json["weighting"] = name(identified.recipe.weighting);
  json["rows_identified"] = split.identify.size();
  json["rows_validated"] = split.validate.size();
  json["coverage"] = data.coverage;
  json["spectral_radius"] = identified.spectral_radius;
  json["mrse_percent"] = result.evidence.mrse_percent;
  json["fit_percent"] = result.evidence.fit_percent;
  json["per_output"] = {{"mrse_percent", to_json(model.validation.mrse_percent)},
                        {"fit_percent", to_json(model.validation.fit_percent)}};
  json["residual_over_span"] = result.evidence.residual_over_span;
  if (result.evidence.champion)
    json["champion"] = {{"version", result.evidence.champion->version},
                        {"mrse_percent", result.evidence.champion->mrse_percent}};
  json["held_out_error"] = identified.held_out_error.value_or(0);
  json["hankel_condition"] = identified.hankel_condition;
  json["singular_values"] = to_json(identified.singular_values);
  json["search_work"] = identified.search_work;
  json["diagnostics"] = to_json(
      diagnose(identified.model, data.record, data.record.all(), split.validate, identified.x0),
      signal_names(model.inputs), signal_names(model.outputs));
  json["warnings"] = identified.warnings;
  return json;
}

void judge(const storage::Archive& archive, const storage::Registry& registry,
           const RefreshRequest& request, const WindowRequest& loaded, const WindowData& data,
           const Identified& identified, const Split& split, RefreshResult& result) {
  EquipmentModel model = candidate_model(request, data, identified, split);
  const Matrix y_hat = free_run(identified.model, data.record, data.record.all(), identified.x0);
  const auto validation = [&](const Matrix& samples) -> Matrix {
    return samples.middleRows(split.validate.begin, split.validate.size());
  };
  model.validation = identification::score(validation(data.record.y), validation(y_hat));

  Evidence& evidence = result.evidence;
  evidence.well_formed = is_well_formed(model.dynamics);
  evidence.spectral_radius = identified.spectral_radius;
  evidence.validation_moves = every_column_moves(validation(data.record.y));
  evidence.mrse_percent = model.validation.mrse();
  evidence.fit_percent = model.validation.fit();
  evidence.residual_over_span =
      residual_over_span(validation(data.record.y), validation(y_hat), data.record.y);
  evidence.window_end = request.window.end;
  evidence.champion =
      champion_evidence(archive, registry, request, loaded, data, model.validated_on);

  const GateDecision decision = decide(evidence, request.equipment);
  result.attempt.outcome = name(decision.outcome);
  result.attempt.reason = decision.reason;
  result.candidate = std::move(model);
  const auto kind = decision.outcome == Outcome::approved  ? storage::DecisionKind::approve
                    : decision.outcome == Outcome::waiting ? storage::DecisionKind::wait
                                                           : storage::DecisionKind::reject;
  result.decision = storage::NewDecision{kind, "gate", decision.reason};
}

void refuse(RefreshResult& result, std::string_view outcome, std::string reason) {
  result.attempt.outcome = outcome;
  result.attempt.reason = std::move(reason);
}

/// Fills in all but the timings.
ordered_json attempt_window(const storage::Archive& archive, const storage::Registry& registry,
                            const RefreshRequest& request, KeptWindow& kept,
                            const identification::ForEach& for_each,
                            const std::function<bool()>& stop, PhaseTimer& timer,
                            RefreshResult& result) {
  timer.begin("load");
  auto outcome = kept.load(archive, request.window);
  if (const auto* unknown = std::get_if<UnknownParameter>(&outcome)) {
    refuse(result, name(Outcome::unknown_parameter),
           fmt::format("Parameter {} has not been described by telemetry yet; check its name in "
                       "the configuration or wait for its descriptor.",
                       unknown->name));
    return ordered_json::object();
  }
  const WindowData& data = std::get<WindowData>(outcome);
  const Split split = split_rows(data.record, request.equipment.validation_share);
  ordered_json evidence = {{"rows_identified", split.identify.size()},
                           {"rows_validated", split.validate.size()},
                           {"coverage", data.coverage}};
  if (data.coverage < request.equipment.min_coverage || split.validate.size() == 0) {
    refuse(result, name(Outcome::low_coverage),
           fmt::format("Only {:.1f} % of the window has every parameter valid; {:g} % are needed.",
                       100 * data.coverage, 100 * request.equipment.min_coverage));
    return evidence;
  }
  identification::IdentifyOptions options = options_of(request.equipment);
  options.for_each = for_each;
  options.on_phase = [&stop, &timer](std::string_view phase) {
    if (stop()) throw Stopped();
    timer.begin(phase);
  };
  const auto identified = identify(data.record, split.identify, options, &kept.sums());
  if (const auto* verdict = std::get_if<identification::Verdict>(&identified)) {
    refuse(result, name(verdict->code), verdict->reason);
    return evidence;
  }
  timer.begin("judge");
  const Identified& model = std::get<Identified>(identified);
  judge(archive, registry, request, kept.request(), data, model, split, result);
  return evidence_json(result, model, data, split);
}

}  // namespace

identification::IdentifyOptions options_of(const EquipmentConfig& equipment) {
  identification::IdentifyOptions options;
  options.input_names = equipment.inputs;
  options.output_names = equipment.outputs;
  options.min_order = equipment.min_order;
  options.max_order = equipment.max_order;
  options.horizon = equipment.horizon;
  return options;
}

KeptWindow kept_window_of(const std::string& spacecraft, const EquipmentConfig& equipment) {
  return {request_of(spacecraft, equipment), block_rows_needed(options_of(equipment))};
}

RefreshResult refresh(const storage::Archive& archive, const storage::Registry& registry,
                      const RefreshRequest& request, KeptWindow& kept,
                      const identification::ForEach& for_each, const std::function<bool()>& stop) {
  RefreshResult result;
  result.attempt.spacecraft = request.spacecraft;
  result.attempt.equipment = request.equipment.name;
  result.attempt.window = request.window;
  result.attempt.trigger = request.trigger;
  result.attempt.configuration_digest = request.configuration_digest;
  result.attempt.program_version = program_version();

  PhaseTimer timer;
  ordered_json evidence =
      attempt_window(archive, registry, request, kept, for_each, stop, timer, result);
  timer.end();
  for (const auto& [phase, milliseconds] : timer.phases())
    evidence["timing_ms"][phase] = milliseconds;
  result.attempt.evidence_json = evidence.dump();
  return result;
}

}  // namespace reident
