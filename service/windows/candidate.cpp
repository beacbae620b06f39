#include "service/windows/candidate.hpp"

#include <cmath>

#include <fmt/format.h>

#include "identification/correction/integral_feedback_search.hpp"
#include "identification/correction/pole_placement_search.hpp"
#include "identification/fit/adaptation.hpp"
#include "identification/fit/static_regression.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/initial_state.hpp"
#include "service/model/diagnostics_json.hpp"
#include "service/model/model_json.hpp"
#include "service/model/reasons.hpp"
#include "service/support/version.hpp"

namespace reident {
namespace {

using identification::Identified;
using identification::Matrix;
using identification::RowRange;
using nlohmann::ordered_json;

storage::TimeRange time_range(const identification::Record& record, RowRange rows,
                              Duration period) {
  if (rows.size() == 0) return {};
  return {time_of_row(record, rows.begin, period),
          time_of_row(record, rows.end - 1, period) + period};
}

std::string method_text(const identification::Recipe& recipe) {
  std::string text =
      fmt::format("{}, horizon {}, order {}", name(recipe.weighting), recipe.horizon, recipe.order);
  if (recipe.fit == identification::ResponseFit::subspace) text += ", B and D of the compression";
  if (recipe.refinement_steps > 0) text += ", refined";
  if (recipe.weighted) text += ", outputs by their errors";
  if (recipe.eliminated_from > 0) text += fmt::format(", left of order {}", recipe.eliminated_from);
  if (recipe.drift_half_periods > 0)
    text += fmt::format(", without {} half periods of drift", recipe.drift_half_periods);
  if (recipe.stability == identification::Stability::enforced) text += ", A made stable";
  return text;
}

struct ChosenModel {
  identification::StateSpaceModel dynamics;
  std::string method;
};

/// The identified model, or that with its poles moved where it errs less on the rows for choices;
/// then with B, D and y0 fitted to these rows too.
ChosenModel corrected(const identification::Record& record, const Identified& identified,
                      const WindowParts& parts, double longest_time_constant_s,
                      const identification::ForEach& for_each, ordered_json& pole_placement) {
  ChosenModel chosen{identified.model, method_text(identified.recipe)};
  const auto search = search_correction(identified.model, record, parts.identify, parts.tune,
                                        for_each ? for_each : identification::in_sequence);
  pole_placement = {{"plain_tune_mrse_percent", search.plain.mrse()}};
  const auto& best = search.best;
  if (best && slowest_time_constant_s(best->model) <= longest_time_constant_s) {
    chosen.dynamics = best->model;
    chosen.method += fmt::format(", poles placed at scale {:.3g}{}", best->scale,
                                 best->keeps_static_gain ? ", static gain kept" : "");
    pole_placement["tune_mrse_percent"] = best->error.mrse();
    pole_placement["scale"] = best->scale;
    pole_placement["keeps_static_gain"] = best->keeps_static_gain;
    pole_placement["uncontrollable_poles"] = best->uncontrollable.size();
  }
  chosen.dynamics =
      adapted(chosen.dynamics, record, parts.fitted(), identification::KnownFrom::these_rows);
  return chosen;
}

void describe_search(const Identified& identified, ordered_json& json) {
  json["horizon"] = identified.recipe.horizon;
  json["weighting"] = name(identified.recipe.weighting);
  json["tune_error"] = identified.held_out_error.value_or(0);
  json["hankel_condition"] = identified.hankel_condition;
  json["singular_values"] = to_json(identified.singular_values);
  if (identified.regimes) json["regimes"] = to_json(*identified.regimes);
  json["search_work"] = identified.search_work;
  json["warnings"] = identified.warnings;
}

void refuse(PreparedWindow& prepared, std::string_view outcome, const Reason& reason) {
  prepared.attempt.outcome = outcome;
  prepared.attempt.reason = sentence(reason);
  prepared.evidence["reasons"] = to_json(std::vector{reason});
}

void refuse(PreparedWindow& prepared, const Reason& reason) {
  refuse(prepared, name(outcome_of({reason})), reason);
}

void identify_window(const RefreshRequest& request, WindowCache& kept,
                     const identification::ForEach& for_each, const std::function<bool()>& stop,
                     PreparedWindow& prepared) {
  const WindowData& data = prepared.data;
  const WindowParts parts = parts_of(data.record.rows(), request.equipment);
  prepared.evidence["rows_identified"] = parts.identify.size();
  prepared.evidence["rows_tuned"] = parts.tune.size();
  prepared.evidence["rows_validated"] = parts.validate.size();
  prepared.evidence["coverage"] = data.coverage;
  if (!data.plausibility.found.empty() || !data.plausibility.not_applied.empty())
    prepared.evidence["implausible"] = to_json(data.plausibility, request.equipment.sample_period);
  const double coverage_percent = 100 * data.coverage;
  const double needed_percent = 100 * request.equipment.min_coverage;
  const bool left_out_too_much = data.read_coverage >= request.equipment.min_coverage &&
                                 data.coverage < request.equipment.min_coverage;
  if (left_out_too_much && !data.plausibility.found.empty())
    // Sensors are not believed on so much of the window that too little is left.
    return refuse(prepared, because<ReasonCode::implausible>(
                                worst_of(data.plausibility, request.equipment.sample_period),
                                coverage_percent, needed_percent));
  if (prepared.least_covered) {
    const auto& [parameter, coverage] = *prepared.least_covered;
    return refuse(prepared, request.equipment.derived.empty()
                                ? because<ReasonCode::low_coverage>(
                                      coverage_percent, needed_percent, parameter, 100 * coverage)
                                : because<ReasonCode::low_coverage_with_derived>(
                                      coverage_percent, needed_percent, parameter, 100 * coverage));
  }
  identification::IdentifyOptions options = options_of(request.equipment);
  options.tune_rows = parts.tune.size();
  // The gate would turn away what is slower: over the window it looks like an integrator.
  options.longest_time_constant_s = 1e-9 * double(request.window.end - request.window.begin);
  options.for_each = for_each;
  options.on_phase = [&stop, &prepared](std::string_view phase) {
    if (stop()) throw Stopped();
    prepared.timer.begin(phase);
  };
  const auto result = identify(data.record, parts.fitted(), options, &kept.sums());
  if (const auto* verdict = std::get_if<identification::Verdict>(&result))
    return refuse(prepared, name(verdict->code), because<ReasonCode::no_model>(verdict->reason));
  prepared.timer.begin("correct");
  const auto& identified = std::get<Identified>(result);
  describe_search(identified, prepared.search);
  const ChosenModel chosen =
      corrected(data.record, identified, parts, options.longest_time_constant_s, for_each,
                prepared.search["pole_placement"]);
  prepared.timer.begin("score");
  prepared.candidate = candidate_of(request, data, chosen.dynamics, chosen.method);
}

}  // namespace

Candidate candidate_of(const RefreshRequest& request, const WindowData& data,
                       const identification::StateSpaceModel& dynamics, const std::string& method) {
  const Duration period = request.equipment.sample_period;
  const WindowParts parts = parts_of(data.record.rows(), request.equipment);
  Candidate candidate{.model = {},
                      .parts = parts,
                      .x0 = estimate_initial_state(dynamics, data.record, data.record.segments,
                                                   identification::state_rows),
                      .y_hat = {},
                      .tuned_on = {},
                      .adapted_from = {}};
  EquipmentModel& model = candidate.model;
  model.spacecraft = request.spacecraft;
  model.equipment = request.equipment.name;
  const auto fitted = [&](const Matrix& samples) {
    return samples.middleRows(parts.fitted().begin, parts.fitted().size());
  };
  model.inputs = with_ranges(data.inputs, fitted(data.record.u));
  model.outputs = with_ranges(data.outputs, fitted(data.record.y));
  model.dynamics = dynamics;
  model.sample_hold_ns = request.equipment.sample_hold;
  if (request.equipment.phase.value_or(0) > 0) model.phase_ns = request.equipment.phase;
  model.identified_from = time_range(data.record, parts.identify, period);
  model.validated_on = time_range(data.record, parts.validate, period);
  model.method = method;
  candidate.tuned_on = time_range(data.record, parts.tune, period);
  candidate.y_hat = free_run(dynamics, data.record, data.record.all(), candidate.x0);
  const auto validation = [&](const Matrix& samples) -> Matrix {
    return samples.middleRows(parts.validate.begin, parts.validate.size());
  };
  model.validation = identification::score(validation(data.record.y), validation(candidate.y_hat));
  return candidate;
}

std::optional<Candidate> adapted_candidate(const RefreshRequest& request,
                                           const EquipmentModel& known, std::int64_t number,
                                           const PreparedWindow& prepared) {
  if (!prepared.candidate || !(request_of(known) == prepared.loaded) ||
      !is_well_formed(known.dynamics) || !(spectral_radius(known.dynamics) < 1))
    return std::nullopt;
  const Eigen::Index order = known.dynamics.order();
  if (order < request.equipment.min_order ||
      order > std::max<Eigen::Index>(request.equipment.max_order,
                                     prepared.candidate->model.dynamics.order()))
    return std::nullopt;
  const WindowParts& parts = prepared.candidate->parts;
  Candidate candidate = candidate_of(request, prepared.data,
                                     adapted(known.dynamics, prepared.data.record, parts.fitted(),
                                             identification::KnownFrom::other_rows),
                                     fmt::format("A and C of version {}", number));
  candidate.adapted_from = number;
  return candidate;
}

Candidate static_candidate(const RefreshRequest& request, const PreparedWindow& prepared) {
  const WindowParts& parts = prepared.candidate->parts;
  return candidate_of(request, prepared.data,
                      static_regression(prepared.data.record, parts.fitted()), "static regression");
}

void describe_candidate(PreparedWindow& prepared) {
  const Candidate& candidate = *prepared.candidate;
  const EquipmentModel& model = candidate.model;
  ordered_json& json = prepared.evidence;
  if (candidate.adapted_from)
    json["identified"] = prepared.search;
  else
    json.update(prepared.search);
  json["order"] = model.dynamics.order();
  json["spectral_radius"] = spectral_radius(model.dynamics);
  json["mrse_percent"] = model.validation.mrse();
  json["fit_percent"] = model.validation.fit();
  json["per_output"] = {{"mrse_percent", to_json(model.validation.mrse_percent)},
                        {"fit_percent", to_json(model.validation.fit_percent)}};
  json["diagnostics"] =
      to_json(diagnose(model.dynamics, prepared.data.record, prepared.data.record.all(),
                       candidate.parts.validate, candidate.x0),
              signal_names(model.inputs), signal_names(model.outputs));
}

void let_follow(PreparedWindow& prepared) {
  const identification::Record& record = prepared.data.record;
  const auto& [identify, tune, validate] = prepared.candidate->parts;
  EquipmentModel& model = prepared.candidate->model;
  prepared.timer.begin("follow");
  const auto result = search_tracking(model.dynamics, record, identify, tune);
  if (const auto* verdict = std::get_if<identification::Verdict>(&result)) {
    prepared.evidence["integral_feedback"] = {{"rejected", name(verdict->code)},
                                              {"reason", verdict->reason}};
    return;
  }
  const auto& found = std::get<identification::TrackingSearch>(result);
  const Matrix y_hat =
      tracked_run(model.dynamics, found.gain, record, record.all(), prepared.candidate->x0);
  model.tracking = {found.gain,
                    identification::score(record.y.middleRows(validate.begin, validate.size()),
                                          y_hat.middleRows(validate.begin, validate.size()))};
  prepared.evidence["integral_feedback"] = {{"scale", found.scale},
                                            {"tau_samples", found.tau_samples},
                                            {"free_run_tune_mrse_percent", found.free_run.mrse()},
                                            {"tracking_tune_mrse_percent", found.tracking.mrse()},
                                            {"uncontrollable_poles", found.uncontrollable.size()}};
  prepared.evidence["tracking_mrse_percent"] = model.tracking->validation.mrse();
}

WindowParts parts_of(identification::Index rows, const EquipmentConfig& equipment) {
  const auto share = [rows](double part) {
    return static_cast<Eigen::Index>(std::llround(static_cast<double>(rows) * part));
  };
  const Eigen::Index validate = rows - share(equipment.validation_share);
  const Eigen::Index tune = std::max<Eigen::Index>(0, validate - share(equipment.tune_share));
  return {{0, tune}, {tune, validate}, {validate, rows}};
}

identification::IdentifyOptions options_of(const EquipmentConfig& equipment) {
  identification::IdentifyOptions options;
  options.input_names = equipment.inputs;
  options.output_names = equipment.outputs;
  options.regime_inputs = equipment.regime_inputs;
  options.min_order = equipment.min_order;
  options.max_order = equipment.max_order;
  options.horizon = equipment.horizon;
  return options;
}

WindowCache window_cache_of(const std::string& spacecraft, const EquipmentConfig& equipment) {
  return {request_of(spacecraft, equipment), block_rows_needed(options_of(equipment)),
          checks_of(equipment)};
}

void refuse_damaged(PreparedWindow& prepared, const storage::Error& error) {
  prepared.candidate.reset();
  refuse(prepared, because<ReasonCode::telemetry_damaged>(error.what()));
}

PreparedWindow loaded_window(const storage::Archive& archive, const RefreshRequest& request,
                             WindowCache& kept) {
  PreparedWindow prepared;
  prepared.attempt.spacecraft = request.spacecraft;
  prepared.attempt.equipment = request.equipment.name;
  prepared.attempt.window = request.window;
  prepared.attempt.trigger = request.trigger;
  prepared.attempt.configuration_digest = request.configuration_digest;
  prepared.attempt.program_version = program_version();
  prepared.loaded = kept.request();
  prepared.checks = checks_of(request.equipment);
  prepared.timer.begin("load");
  try {
    auto outcome = kept.load(archive, request.window);
    if (const auto* unknown = std::get_if<UnknownParameter>(&outcome)) {
      refuse(prepared, because<ReasonCode::unknown_parameter>(unknown->name));
      return prepared;
    }
    const WindowData& data = prepared.data = std::get<WindowData>(std::move(outcome));
    if (data.coverage < request.equipment.min_coverage ||
        parts_of(data.record.rows(), request.equipment).validate.size() == 0)
      prepared.least_covered = least_covered(archive, kept.request(), data, request.window);
  } catch (const storage::Error& error) {
    if (error.kind() != storage::Error::Kind::corrupt) throw;
    refuse_damaged(prepared, error);
  }
  return prepared;
}

PreparedWindow prepare_window(const storage::Archive& archive, const RefreshRequest& request,
                              WindowCache& kept, const identification::ForEach& for_each,
                              const std::function<bool()>& stop) {
  PreparedWindow prepared = loaded_window(archive, request, kept);
  if (prepared.attempt.outcome.empty()) identify_window(request, kept, for_each, stop, prepared);
  prepared.timer.end();
  return prepared;
}

}  // namespace reident
