#include "identification/identify.hpp"

#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/command.hpp"
#include "service/cli/identify_data.hpp"
#include "service/cli/identify_result.hpp"
#include "service/support/phase_timer.hpp"

namespace reident::cli {
namespace {

using identification::Identified;
using identification::IdentifyOptions;
using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::RowRange;
using identification::Verdict;

constexpr int max_order = 100;
constexpr int max_horizon = 500;

struct Arguments {
  DataRequest data;
  std::string order = "auto";
  std::string horizon = "auto";
  bool json = false;
};

/// "auto" leaves the choice to the identification.
std::optional<Refusal> parse_choice(std::string_view flag, const std::string& text, int low,
                                    int high, std::optional<int>& choice) {
  if (text == "auto") return std::nullopt;
  const std::optional<std::int64_t> value = whole_number(text);
  if (!value || *value < low || *value > high)
    return Refusal{fmt::format("{} {} is neither auto nor a whole number from {} to {}", flag, text,
                               low, high)};
  choice = static_cast<int>(*value);
  return std::nullopt;
}

std::optional<Refusal> parse_options(const Arguments& arguments, IdentifyOptions& options) {
  // --input and --output take all words that follow them.
  if (arguments.data.file.empty())
    return Refusal{"no file; name the CSV file before the flags: identify FILE.csv --input ..."};
  if (auto refusal = parse_choice("--order", arguments.order, 1, max_order, options.order))
    return refusal;
  if (auto refusal = parse_choice("--horizon", arguments.horizon, 2, max_horizon, options.horizon))
    return refusal;
  const auto outputs = static_cast<int>(arguments.data.outputs.size());
  if (options.order && options.horizon && *options.order > outputs * (*options.horizon - 1))
    return Refusal{fmt::format("--horizon {} is too short for --order {}; make it at least {}",
                               *options.horizon, *options.order,
                               (*options.order + outputs - 1) / outputs + 1)};
  const auto& period = arguments.data.period_s;
  if (period && !(*period >= 1e-9 && *period <= 1e9))
    return Refusal{fmt::format("--period {} must be seconds from 1e-9 to 1e9", *period)};
  return std::nullopt;
}

/// The rows of one simulation, and where its first segment's state comes from.
struct Run {
  RowRange rows;
  Matrix y_hat;
};

Run run_from(const Identified& identified, const IdentifyData& data, RowRange rows, bool from_x0,
             std::vector<std::string>& warnings) {
  const std::optional<identification::Vector> x0 =
      from_x0 ? std::optional(identified.x0) : std::nullopt;
  const std::size_t stretches = segments_within(data.record, rows).size();
  const Index looked_at = initial_rows(identified.model);
  if (!from_x0)
    warnings.push_back(fmt::format(
        "the validation rows begin before the identification rows: their initial state is the "
        "least-squares estimate from their first {} rows",
        looked_at));
  if (stretches > 1)
    warnings.push_back(fmt::format(
        "gaps split the simulated rows into {} stretches: the state at the start of each after the "
        "first is the least-squares estimate from its first {} rows",
        stretches, looked_at));
  return {rows, free_run(identified.model, data.record, rows, x0)};
}

identification::Score score_part(const Run& run, const Record& record, RowRange part) {
  return identification::score(record.y.middleRows(part.begin, part.size()),
                               run.y_hat.middleRows(part.begin - run.rows.begin, part.size()));
}

/// One simulation from x0 at the first identification row to the last row of both ranges; rows
/// before the identification need another.
void score_outcome(const IdentifyData& data, IdentifyOutcome& outcome) {
  const bool before = data.validate.begin < data.identify.begin;
  const Index end = before ? data.identify.end : std::max(data.identify.end, data.validate.end);
  const Run run =
      run_from(outcome.identified, data, {data.identify.begin, end}, true, outcome.warnings);
  outcome.identify = score_part(run, data.record, data.identify);
  outcome.validate =
      before
          ? score_part(run_from(outcome.identified, data, data.validate, false, outcome.warnings),
                       data.record, data.validate)
          : score_part(run, data.record, data.validate);
}

int print_rejection(const Verdict& verdict, bool json) {
  if (json) {
    const nlohmann::ordered_json object = {{"rejected", name(verdict.code)},
                                           {"reason", verdict.reason}};
    fmt::print("{}\n", object.dump());
  } else {
    fmt::print(stderr, "reident: no model ({}): {}\n", name(verdict.code), verdict.reason);
  }
  return exit_no_model;
}

int run(const Arguments& arguments) {
  IdentifyOptions options;
  if (const auto refusal = parse_options(arguments, options)) return refuse(*refusal);
  PhaseTimer timer;
  timer.begin("read");
  auto read = read_data(arguments.data);
  if (const auto* refusal = std::get_if<Refusal>(&read)) return refuse(*refusal);
  auto& data = std::get<IdentifyData>(read);
  timer.end();

  options.on_phase = [&timer](std::string_view phase) { timer.begin(phase); };
  auto result = identification::identify(data.record, data.identify, options);
  if (const auto* verdict = std::get_if<Verdict>(&result))
    return print_rejection(*verdict, arguments.json);

  timer.begin("score");
  IdentifyOutcome outcome;
  outcome.identified = std::get<Identified>(std::move(result));
  outcome.inputs = data.inputs;
  outcome.outputs = data.outputs;
  outcome.warnings = data.warnings;
  const auto& own = outcome.identified.warnings;
  outcome.warnings.insert(outcome.warnings.end(), own.begin(), own.end());
  score_outcome(data, outcome);
  timer.end();
  outcome.timing_ms = timer.phases();
  fmt::print("{}", arguments.json ? to_json_text(outcome) : to_report(outcome));
  return exit_done;
}

}  // namespace

void add_identify(CLI::App& app, int& exit_code) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand(
      "identify", "Identify a state-space model from a CSV file and score it on other rows");
  command->add_option("file", arguments->data.file, "CSV file with a header row; opened read-only");
  command->add_option("--input", arguments->data.inputs, "columns that drive the model")
      ->required();
  command->add_option("--output", arguments->data.outputs, "columns that the model computes")
      ->required();
  command->add_option("--time", arguments->data.time,
                      "column of times: seconds or ISO 8601; gaps split the rows");
  command->add_option("--period", arguments->data.period_s,
                      "seconds between rows, or of the grid with --time (the median step)");
  command->add_option("--identify", arguments->data.identify,
                      "rows A:B of the file, 0-based and half-open (the first two thirds)");
  command->add_option("--validate", arguments->data.validate,
                      "rows C:D to score on (those after the identification rows)");
  command->add_option("--order", arguments->order, "auto or the number of states")
      ->capture_default_str();
  command->add_option("--horizon", arguments->horizon, "auto or the number of block rows")
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object with matrices, x0 and errors");
  command->footer(
      "Example:\n"
      "  reident identify dryer.csv --input u1 --output y1 --identify 0:500 --validate 500:1000\n"
      "Exit status: 2 for an impossible request, 3 when the data give no model.");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}

}  // namespace reident::cli
