#include "service/cli/identify_result.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "identification/numerics/decompositions.hpp"
#include "identification/search/delays.hpp"
#include "service/cli/output/diagnostics_text.hpp"
#include "service/cli/output/model_text.hpp"
#include "service/cli/output/table.hpp"
#include "service/model/diagnostics_json.hpp"
#include "service/model/model_json.hpp"

namespace reident::cli {
namespace {

using identification::Score;
using identification::StateSpaceModel;
using nlohmann::ordered_json;

std::string dumped(const ordered_json& value) {
  return value.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

bool all_finite(const Score& score) {
  return score.mrse_percent.allFinite() && score.fit_percent.allFinite();
}

/// Rows that do not move have no fit.
std::string fit_text(const Score& score, Eigen::Index output) {
  const bool constant =
      std::isinf(score.fit_percent(output)) && std::isfinite(score.mrse_percent(output));
  return constant ? "constant" : fmt::format("{:.4g}", score.fit_percent(output));
}

Table error_table(const IdentifyOutcome& outcome) {
  Table table({{"output"},
               {"MRSE identify %", Table::Align::right},
               {"MRSE validate %", Table::Align::right},
               {"fit identify %", Table::Align::right},
               {"fit validate %", Table::Align::right}});
  for (std::size_t q = 0; q < outcome.outputs.size(); ++q) {
    const auto at = static_cast<Eigen::Index>(q);
    table.add({outcome.outputs[q], fmt::format("{:.4g}", outcome.identify.mrse_percent(at)),
               fmt::format("{:.4g}", outcome.diagnostics.free_run.mrse_percent(at)),
               fit_text(outcome.identify, at), fit_text(outcome.diagnostics.free_run, at)});
  }
  return table;
}

/// What was chosen besides order, horizon and weighting, and on what grounds.
ordered_json recipe_json(const identification::Identified& identified) {
  const identification::Recipe& recipe = identified.recipe;
  const bool of_subspace = recipe.fit == identification::ResponseFit::subspace;
  const bool enforced = recipe.stability == identification::Stability::enforced;
  const bool recent = recipe.operating_point == identification::OperatingPoint::recent;
  ordered_json json = {{"response", of_subspace ? "subspace" : "simulation"},
                       {"direct", recipe.direct},
                       {"operating_point", recent ? "recent" : "whole"},
                       {"refinement_steps", recipe.refinement_steps},
                       {"eliminated_from", recipe.eliminated_from},
                       {"drift_half_periods", recipe.drift_half_periods},
                       {"weighted", recipe.weighted},
                       {"stability", enforced ? "enforced" : "as_found"},
                       {"input_delays", identified.input_delays},
                       {"held_out_error", nullptr},
                       {"singular_values", to_json(identified.singular_values)},
                       {"hankel_condition", identified.hankel_condition}};
  if (identified.held_out_error) json["held_out_error"] = *identified.held_out_error;
  return json;
}

/// ", fuel delayed by 25 samples", or "".
std::string delays_text(const IdentifyOutcome& outcome) {
  std::string text;
  const std::vector<int>& delays = outcome.identified.input_delays;
  for (std::size_t i = 0; i < delays.size(); ++i)
    if (delays[i] > 0)
      text += fmt::format(", {} delayed by {} samples", outcome.inputs[i], delays[i]);
  return text;
}

double rows_s(const IdentifyOutcome& outcome) {
  return outcome.identified.model.period_s * static_cast<double>(outcome.identify.rows);
}

/// 1 / |s| of the slowest mode [s]: of an oscillation that does not decay, its period over 2 pi.
double slowest_mode_s(const StateSpaceModel& model) {
  double slowest = 0;
  for (const std::complex<double>& mode : identification::eigenvalues(model.A))
    slowest = std::max(slowest, model.period_s / std::abs(std::log(mode)));
  return slowest;
}

/// Absent where a mode is slower than the rows.
std::optional<identification::Matrix> shown_gain(const IdentifyOutcome& outcome) {
  const StateSpaceModel& model = outcome.identified.model;
  return slowest_mode_s(model) <= rows_s(outcome) ? static_gain(model) : std::nullopt;
}

/// A line for each output.
std::string gains_text(const IdentifyOutcome& outcome) {
  const StateSpaceModel& model = outcome.identified.model;
  const auto gain = shown_gain(outcome);
  if (outcome.inputs.empty()) return "";
  if (!gain)
    return fmt::format(
        "gains at rest: none that the rows show; the slowest mode lasts {:.3g} s, the "
        "identification rows {:.3g} s\n",
        slowest_mode_s(model), rows_s(outcome));
  std::string text;
  const auto& uncertainty = outcome.identified.gain_uncertainty;
  const auto& regimes = outcome.identified.regimes;
  const std::size_t inputs =
      outcome.inputs.size() - (regimes && !regimes->are_used ? outcome.regime_inputs : 0);
  for (std::size_t q = 0; q < outcome.outputs.size(); ++q) {
    text += fmt::format("gains at rest to {}:", outcome.outputs[q]);
    for (std::size_t i = 0; i < inputs; ++i) {
      const auto row = static_cast<Eigen::Index>(q), column = static_cast<Eigen::Index>(i);
      text +=
          fmt::format("{} {} {:.4g}", i == 0 ? "" : ",", outcome.inputs[i], (*gain)(row, column));
      if (uncertainty && (*uncertainty)(row, column) > 0)
        text += fmt::format(" +-{:.2g}", (*uncertainty)(row, column));
    }
    text += "\n";
  }
  return text;
}

std::string regimes_text(const IdentifyOutcome& outcome) {
  const auto& regimes = outcome.identified.regimes;
  if (!regimes) return "";
  std::string text = fmt::format("regimes {}: {}", fmt::join(outcome.regimes, ", "),
                                 regimes->are_used ? "used" : "not used");
  if (regimes->error_with && regimes->error_without)
    text += fmt::format(" (held-out error {:.4g} with, {:.4g} without)", *regimes->error_with,
                        *regimes->error_without);
  else if (!regimes->are_used)
    text += " (the rows do not meet them, or give no model with them)";
  return text + "\n";
}

ordered_json regimes_json(const IdentifyOutcome& outcome) {
  if (!outcome.identified.regimes) return nullptr;
  ordered_json json = to_json(*outcome.identified.regimes);
  json["conditions"] = outcome.regimes;
  return json;
}

ordered_json gains_json(const IdentifyOutcome& outcome) {
  const auto gain = shown_gain(outcome);
  return gain ? to_json(*gain) : ordered_json();
}

ordered_json gain_uncertainty_json(const IdentifyOutcome& outcome) {
  const auto& uncertainty = outcome.identified.gain_uncertainty;
  return uncertainty && shown_gain(outcome) ? to_json(*uncertainty) : ordered_json();
}

ordered_json derived_json(const std::vector<DerivedInput>& derived) {
  ordered_json list = ordered_json::array();
  for (const DerivedInput& input : derived)
    list.push_back({{"name", input.name}, {"expression", input.expression}});
  return list;
}

}  // namespace

std::string to_json_text(const IdentifyOutcome& outcome) {
  const StateSpaceModel& model = outcome.identified.model;
  ordered_json warnings = outcome.warnings;
  if (!all_finite(outcome.identify) || !all_finite(outcome.diagnostics.free_run))
    warnings.push_back(
        "an error or a fit is not finite, since an output is zero or does not move; it is null");
  ordered_json timing = ordered_json::object();
  for (const auto& [phase, milliseconds] : outcome.timing_ms) timing[phase] = milliseconds;

  const std::pair<const char*, ordered_json> entries[] = {
      {"order", model.order()},
      {"horizon", outcome.identified.recipe.horizon},
      {"weighting", name(outcome.identified.recipe.weighting)},
      {"recipe", recipe_json(outcome.identified)},
      {"sample_period_s", model.period_s},
      {"phase_ns", outcome.phase_ns},
      {"inputs", outcome.inputs},
      {"outputs", outcome.outputs},
      {"derived", derived_json(outcome.derived)},
      {"regimes", regimes_json(outcome)},
      {"A", to_json(model.A)},
      {"B", to_json(model.B)},
      {"C", to_json(model.C)},
      {"D", to_json(model.D)},
      {"K", to_json(model.K)},
      {"x0", to_json(outcome.identified.x0)},
      {"input_offset", to_json(model.u0)},
      {"output_offset", to_json(model.y0)},
      {"static_gain", gains_json(outcome)},
      {"static_gain_uncertainty", gain_uncertainty_json(outcome)},
      {"stable", outcome.identified.spectral_radius < 1},
      {"spectral_radius", outcome.identified.spectral_radius},
      {"mrse_percent",
       {{"identify", to_json(outcome.identify.mrse_percent)},
        {"validate", to_json(outcome.diagnostics.free_run.mrse_percent)}}},
      {"fit_percent",
       {{"identify", to_json(outcome.identify.fit_percent)},
        {"validate", to_json(outcome.diagnostics.free_run.fit_percent)}}},
      {"diagnostics", to_json(outcome.diagnostics, outcome.inputs, outcome.outputs)},
      {"continuous", to_json(outcome.continuous)},
      {"search_work", outcome.identified.search_work},
      {"left_out", outcome.left_out},
      {"timing_ms", timing},
      {"warnings", warnings},
      {"found", outcome.found}};
  std::string text;
  for (const auto& [key, value] : entries)
    text += fmt::format("{}\n  \"{}\": {}", text.empty() ? "{" : ",", key, dumped(value));
  return text + "\n}\n";
}

std::string to_report(const IdentifyOutcome& outcome) {
  const identification::Identified& identified = outcome.identified;
  const StateSpaceModel model = without_delay_states(identified.model, identified.input_delays);
  double total = 0;
  for (const auto& [phase, milliseconds] : outcome.timing_ms) total += milliseconds;
  std::string text = fmt::format(
      "order {}{}, horizon {}, weighting {}, sample period {:g} s\n"
      "poles {} (spectral radius {:.6g}, {})\n"
      "{}{}free run over {} identification and {} validation rows:\n{}",
      model.order(), delays_text(outcome), identified.recipe.horizon,
      name(identified.recipe.weighting), model.period_s, poles_text(model),
      identified.spectral_radius, identified.spectral_radius < 1 ? "stable" : "unstable",
      regimes_text(outcome), gains_text(outcome), outcome.identify.rows,
      outcome.diagnostics.free_run.rows, error_table(outcome).text(0));
  text += diagnostics_text(outcome.diagnostics, outcome.inputs, outcome.outputs);
  text += continuous_text(outcome.continuous);
  for (const std::string& warning : outcome.warnings) text += fmt::format("warning: {}\n", warning);
  return text + fmt::format("{:.0f} ms; --json prints the matrices\n", total);
}

}  // namespace reident::cli
