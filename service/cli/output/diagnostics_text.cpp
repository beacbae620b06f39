#include "service/cli/output/diagnostics_text.hpp"

#include <cmath>

#include <fmt/format.h>

#include "service/cli/output/table.hpp"

namespace reident::cli {
namespace {

using identification::CorrelationSummary;
using identification::Diagnostics;
using identification::Index;
using identification::InputCorrelation;
using identification::Whiteness;
using Names = std::vector<std::string>;

// Correlations below this explain less than 1 % of what is left: with many rows they stand out from
// chance and yet mean nothing to anyone.
constexpr double worth_a_word = 0.1;

std::string rows_text(Index count) {
  return fmt::format("{} row{}", count, count == 1 ? "" : "s");
}

std::string confidence_table(const Diagnostics& diagnostics, const Names& outputs) {
  const identification::ErrorSpread& spread = diagnostics.spread;
  const auto& interval = diagnostics.interval;
  std::vector<Table::Column> columns = {{"output"}, {"MRSE % (95 % interval)"}};
  if (spread.parts > 1) {
    columns.push_back({fmt::format("in {} parts: best", spread.parts), Table::Align::right});
    columns.push_back({"median", Table::Align::right});
    columns.push_back({"worst", Table::Align::right});
  }
  Table table(columns);
  for (std::size_t q = 0; q < outputs.size(); ++q) {
    const auto at = static_cast<Index>(q);
    std::string error = fmt::format("{:.4g}", diagnostics.free_run.mrse_percent(at));
    if (interval)
      error += fmt::format(" ({:.4g} to {:.4g})", interval->low(at), interval->high(at));
    std::vector<std::string> cells = {outputs[q], error};
    if (spread.parts > 1)
      for (const double value : {spread.smallest(at), spread.median(at), spread.largest(at)})
        cells.push_back(fmt::format("{:.4g}", value));
    table.add(std::move(cells));
  }
  return table.text(0);
}

std::string prediction_table(const Diagnostics& diagnostics, const Names& outputs) {
  std::vector<Table::Column> columns = {{"output"}};
  for (const auto& prediction : diagnostics.predictions)
    columns.push_back({fmt::format("{} ahead", prediction.steps), Table::Align::right});
  columns.push_back({"free run", Table::Align::right});
  Table table(columns);
  for (std::size_t q = 0; q < outputs.size(); ++q) {
    const auto at = static_cast<Index>(q);
    std::vector<std::string> cells = {outputs[q]};
    for (const auto& prediction : diagnostics.predictions)
      cells.push_back(fmt::format("{:.4g}", prediction.score.mrse_percent(at)));
    cells.push_back(fmt::format("{:.4g}", diagnostics.free_run.mrse_percent(at)));
    table.add(std::move(cells));
  }
  return table.text(0);
}

std::string whiteness_text(const Whiteness& whiteness) {
  const CorrelationSummary& found = whiteness.correlation;
  if (found.lags == 0) return "too few rows to tell";
  if (whiteness.portmanteau.white()) return "white, nothing left but chance";
  return fmt::format("{} (r = {:.2g} with itself {} before; chance: {:.2g})",
                     std::abs(found.largest) < worth_a_word ? "nearly white" : "not white",
                     found.largest, rows_text(found.lag), found.bound);
}

/// "" for a correlation that is chance or says little.
std::string input_text(const InputCorrelation& pair, const Names& inputs) {
  const CorrelationSummary& found = pair.correlation;
  if (!found.significant() || std::abs(found.largest) < worth_a_word) return "";
  const std::string& input = inputs[static_cast<std::size_t>(pair.input)];
  if (found.lag < 0)
    return fmt::format("; {} follows it by {}: feedback", input, rows_text(-found.lag));
  const std::string when =
      found.lag == 0 ? "of the same row" : fmt::format("of {} before", rows_text(found.lag));
  return fmt::format("; {} {} would explain {:.2g} % of it", input, when,
                     100 * found.largest * found.largest);
}

std::string residuals_text(const Diagnostics& diagnostics, const Names& inputs,
                           const Names& outputs) {
  std::string text;
  for (std::size_t q = 0; q < outputs.size(); ++q) {
    std::string explained;
    for (const InputCorrelation& pair :
         diagnostics.predicted ? diagnostics.prediction_inputs : diagnostics.free_run_inputs)
      if (pair.output == static_cast<Index>(q)) explained += input_text(pair, inputs);
    if (explained.empty() && !inputs.empty() && diagnostics.whiteness[q].correlation.lags > 0)
      explained = "; no input would explain more of it linearly";
    text += fmt::format("  {}: {}{}\n", outputs[q], whiteness_text(diagnostics.whiteness[q]),
                        explained);
  }
  return text;
}

}  // namespace

std::string diagnostics_text(const Diagnostics& diagnostics, const Names& inputs,
                             const Names& outputs) {
  std::string text = fmt::format("how sure the error on the validation rows ({}) is:\n{}",
                                 diagnostics.rows, confidence_table(diagnostics, outputs));
  if (diagnostics.interval && diagnostics.interval->too_few_rows)
    text +=
        "the errors go on for so long that these rows are too few: the interval is too narrow\n";
  if (diagnostics.predicted)
    text += fmt::format(
        "MRSE % when K corrects the state by the outputs up to so many rows before:\n{}",
        prediction_table(diagnostics, outputs));
  text += diagnostics.predicted ? "what the prediction of the next row leaves:\n"
                                : "what the free run leaves (the model has no K):\n";
  return text + residuals_text(diagnostics, inputs, outputs);
}

}  // namespace reident::cli
