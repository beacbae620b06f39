#include "service/model/diagnostics_json.hpp"

#include "service/model/model_json.hpp"

namespace reident {
namespace {

using identification::CorrelationSummary;
using identification::Diagnostics;
using identification::InputCorrelation;
using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

const std::string& name_at(const Names& names, identification::Index at) {
  return names[static_cast<std::size_t>(at)];
}

void put(Json& json, const CorrelationSummary& summary) {
  json["lags"] = summary.lags;
  json["largest"] = summary.largest;
  json["lag"] = summary.lag;
  json["bound"] = summary.bound;
  json["joint_bound"] = summary.joint_bound;
  json["share_outside"] = summary.share_outside;
}

Json whiteness_json(const Diagnostics& diagnostics, const Names& outputs) {
  Json array = Json::array();
  for (std::size_t q = 0; q < diagnostics.whiteness.size(); ++q) {
    const identification::Whiteness& whiteness = diagnostics.whiteness[q];
    Json json = {{"output", outputs[q]}, {"white", whiteness.portmanteau.white()}};
    put(json, whiteness.correlation);
    json["ljung_box"] = whiteness.portmanteau.statistic;
    json["ljung_box_limit"] = whiteness.portmanteau.limit;
    array.push_back(std::move(json));
  }
  return array;
}

Json input_correlations_json(const std::vector<InputCorrelation>& pairs, const Names& inputs,
                             const Names& outputs) {
  Json array = Json::array();
  for (const InputCorrelation& pair : pairs) {
    Json json = {{"input", name_at(inputs, pair.input)},
                 {"output", name_at(outputs, pair.output)},
                 {"significant", pair.correlation.significant()}};
    put(json, pair.correlation);
    array.push_back(std::move(json));
  }
  return array;
}

Json predictions_json(const Diagnostics& diagnostics) {
  Json array = Json::array();
  for (const auto& [steps, score] : diagnostics.predictions)
    array.push_back({{"steps", steps},
                     {"mrse_percent", to_json(score.mrse_percent)},
                     {"fit_percent", to_json(score.fit_percent)}});
  return array;
}

Json interval_json(const std::optional<identification::ErrorInterval>& interval) {
  if (!interval) return nullptr;
  return {{"low", to_json(interval->low)},         {"high", to_json(interval->high)},
          {"mean_low", interval->mean_low},        {"mean_high", interval->mean_high},
          {"block_rows", interval->block_rows},    {"replicates", interval->replicates},
          {"too_few_rows", interval->too_few_rows}};
}

}  // namespace

Json to_json(const Diagnostics& diagnostics, const Names& inputs, const Names& outputs) {
  const identification::ErrorSpread& spread = diagnostics.spread;
  return {{"rows", diagnostics.rows},
          {"residuals", diagnostics.predicted ? "prediction" : "free_run"},
          {"whiteness", whiteness_json(diagnostics, outputs)},
          {"input_correlation",
           {{"prediction", input_correlations_json(diagnostics.prediction_inputs, inputs, outputs)},
            {"free_run", input_correlations_json(diagnostics.free_run_inputs, inputs, outputs)}}},
          {"prediction", predictions_json(diagnostics)},
          {"free_run",
           {{"mrse_percent", to_json(diagnostics.free_run.mrse_percent)},
            {"fit_percent", to_json(diagnostics.free_run.fit_percent)}}},
          {"mrse_interval_percent", interval_json(diagnostics.interval)},
          {"mrse_of_parts_percent",
           {{"parts", spread.parts},
            {"smallest", to_json(spread.smallest)},
            {"median", to_json(spread.median)},
            {"largest", to_json(spread.largest)}}}};
}

Json to_json(const identification::RegimeChoice& regimes) {
  const auto number = [](const std::optional<double>& error) {
    return error ? Json(*error) : Json(nullptr);
  };
  return {{"used", regimes.are_used},
          {"held_out_error", number(regimes.error_with)},
          {"held_out_error_without", number(regimes.error_without)}};
}

Json to_json(
    const std::variant<identification::ContinuousModel, identification::Verdict>& continuous) {
  if (const auto* verdict = std::get_if<identification::Verdict>(&continuous))
    return {{"rejected", name(verdict->code)}, {"reason", verdict->reason}};
  const auto& model = std::get<identification::ContinuousModel>(continuous);
  return {{"A", to_json(model.A)}, {"B", to_json(model.B)}};
}

}  // namespace reident
