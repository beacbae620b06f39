#include "identification/search/identify.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "identification/search/delays.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/initial_state.hpp"
#include "identification/simulation/scores.hpp"
#include "identification/statistics/shifts.hpp"
#include "service/cli/identify_data.hpp"
#include "service/cli/identify_options.hpp"
#include "service/cli/identify_result.hpp"
#include "service/cli/identify_screening.hpp"
#include "service/cli/identify_unexplained.hpp"
#include "service/cli/verb.hpp"
#include "service/support/parallel.hpp"
#include "service/support/phase_timer.hpp"
#include "service/support/terminal.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"
#include "service/telemetry_file/long_layout.hpp"
#include "service/telemetry_file/reading_options.hpp"

namespace reident::cli::identify_verb {
namespace {

using identification::Identified;
using identification::IdentifyOptions;
using identification::Index;
using identification::RowRange;
using identification::Vector;
using identification::Verdict;

constexpr std::size_t max_threads = 256;

struct Arguments {
  DataRequest data;
  telemetry_file::ReadingArguments reading;
  std::optional<std::string> hold, phase;
  ModelRequest model;
  std::optional<std::string> threads;
  bool json = false;
};

/// Absent where the request is impossible.
std::optional<std::size_t> threads_of(const Arguments& arguments) {
  if (!arguments.threads) return std::min(usable_cores(), max_threads);
  const auto asked = whole_number(*arguments.threads);
  if (!asked || *asked < 1) return std::nullopt;
  const auto threads = static_cast<std::size_t>(*asked);
  return threads <= max_threads ? std::optional(threads) : std::nullopt;
}

/// What can be said before the file is read.
std::optional<Refusal> refuse_arguments(const Arguments& arguments) {
  // --input and --output take all words that follow them.
  if (arguments.data.file.empty())
    return Refusal{"no file; name the CSV file before the flags: identify FILE.csv --input ..."};
  const auto& period = arguments.data.period_s;
  if (period && !(*period >= 1e-9 && *period <= 1e9))
    return Refusal{fmt::format("--period {} must be seconds from 1e-9 to 1e9", *period)};
  if (!threads_of(arguments))
    return Refusal{fmt::format("--threads {} is no whole number from 1 to {}", *arguments.threads,
                               max_threads)};
  return std::nullopt;
}

/// A model may explain the rows that it was chosen on and not the ones behind them. Rows in which
/// an output does not move by more than a digit, or than the model errs where it was identified,
/// say nothing of that: of such rows noise is all that there is to explain, and no model's fit is
/// far above 0.
void warn_of_useless_outputs(const IdentifyData& data, IdentifyOutcome& outcome) {
  constexpr double as_before = 1.2;  // times the error on the identification rows
  constexpr double as_noise = 3;     // times what the output changes by from row to row
  constexpr double much_less = 0.5;  // of the fit on the identification rows
  const auto rows_of = [&](Index q, RowRange range) {
    return data.record.y.col(q).segment(range.begin, range.size());
  };
  const auto error_of = [&](Index q, RowRange range, double mrse_percent) {
    return mrse_percent / 100 *
           std::sqrt(rows_of(q, range).squaredNorm() / static_cast<double>(range.size()));
  };
  for (Index q = 0; q < data.record.y.cols(); ++q) {
    const std::string& output = outcome.outputs[static_cast<std::size_t>(q)];
    const auto rows = rows_of(q, data.validate);
    const double error = error_of(q, data.validate, outcome.diagnostics.free_run.mrse_percent(q));
    const double before = error_of(q, data.identify, outcome.identify.mrse_percent(q));
    const double fit = outcome.diagnostics.free_run.fit_percent(q);
    const double fit_before = outcome.identify.fit_percent(q);
    const double movement = std::sqrt((rows.array() - rows.mean()).square().mean());
    const double change =
        std::sqrt((rows.tail(rows.size() - 1) - rows.head(rows.size() - 1)).squaredNorm() / 2 /
                  static_cast<double>(rows.size()));
    const double resolution = identification::resolution(data.record.y.col(q));
    const double rounding = 1e-12 * std::abs(rows(0));
    if (rows.maxCoeff() - rows.minCoeff() <= resolution + rounding)
      outcome.warnings.push_back(fmt::format(
          "the validation rows of {} are constant: they say nothing about the fit. {}{} is "
          "resolved "
          "to {:.3g}; choose rows in which it moves with --validate",
          output, std::isfinite(error) ? fmt::format("The error there is {:.3g}, and ", error) : "",
          output, resolution));
    else if (fit_before > 0 && fit < much_less * fit_before &&
             std::max(error, movement) <= as_before * before && movement <= as_noise * change)
      outcome.warnings.push_back(fmt::format(
          "on the validation rows {} moves by no more than the model errs everywhere: they say "
          "nothing about the fit. The error there is {:.3g}, and on the identification rows "
          "{:.3g}; choose rows in which it moves with --validate",
          output, error, before));
    else if (fit < 0)
      outcome.warnings.push_back(fmt::format(
          "on the validation rows the model is worse than the mean of {}: do not use it as it is",
          output));
  }
}

/// What happens to the state in a simulation of `rows`.
void warn_of_states(const IdentifyData& data, RowRange rows, bool from_x0,
                    std::vector<std::string>& warnings) {
  const std::size_t segments = segments_within(data.record, rows).size();
  if (!from_x0)
    warnings.push_back(fmt::format(
        "the validation rows begin before the identification rows: their initial state is the "
        "least-squares estimate from their first {} rows",
        identification::state_rows));
  if (segments > 1)
    warnings.push_back(fmt::format(
        "gaps split the simulated rows into {} stretches: the state goes through short gaps with "
        "interpolated inputs, and behind long ones it is the least-squares estimate from the first "
        "{} rows",
        segments, identification::state_rows));
}

/// A sentence for each output of which a bend of inputs would explain much of what is `left`.
std::vector<std::string> bend_sentences(const std::vector<identification::Bend>& bends,
                                        const IdentifyData& data, std::string_view left) {
  constexpr double worth_a_word = 0.4;  // a sixth of what is left
  std::vector<std::string> sentences;
  for (std::size_t q = 0; q < bends.size(); ++q) {
    const auto& [input, other, found] = bends[q];
    if (found.lags == 0 || !found.significant() || std::abs(found.largest) <= worth_a_word)
      continue;
    const std::string &y = data.outputs[q], &u = data.inputs[static_cast<std::size_t>(input)],
                      &by = data.inputs[static_cast<std::size_t>(other)];
    const std::string share =
        fmt::format("would explain {:.2g} % of {}", 100 * found.largest * found.largest, left);
    sentences.push_back(
        input == other
            ? fmt::format("{} is not linear in {}: the square of this, or its product with its "
                          "size, {}; --derive an input that {} is linear in, or --regime",
                          y, u, share, y)
            : fmt::format("{} is not linear in {} and {}: their product {}; --derive it as an "
                          "input, such as \"P={}*{}\", or --regime",
                          y, u, by, share, u, by));
  }
  return sentences;
}

/// `y_hat` is the free run over `rows`.
void warn_of_shifts(const IdentifyData& data, RowRange rows, const identification::Matrix& y_hat,
                    IdentifyOutcome& outcome) {
  const std::vector<RowRange> segments = ranges_from(data.record, rows);
  identification::Matrix columns(rows.size(), data.record.u.cols() + y_hat.cols());
  columns << data.record.u.middleRows(rows.begin, rows.size()), y_hat;
  for (Index q = 0; q < y_hat.cols(); ++q) {
    const auto shift =
        shift_of(data.record.y.col(q).segment(rows.begin, rows.size()) - y_hat.col(q), y_hat.col(q),
                 columns, segments);
    if (!shift) continue;
    const Index row = file_row(data, rows.begin + shift->row);
    const std::string& output = outcome.outputs[static_cast<std::size_t>(q)];
    outcome.warnings.push_back(fmt::format(
        "{}; identify on one side with --identify A:B, or name a column that tells them apart with "
        "--regime",
        shift->of == identification::Shift::Of::mean
            ? fmt::format("{} is {} by {:.3g} from about row {} on, which the inputs do not "
                          "explain: its sensor has another zero or drifts, or the equipment is "
                          "another",
                          output, shift->size < 0 ? "lower" : "higher", std::abs(shift->size), row)
            : fmt::format(
                  "{} answers its inputs by {:.2g} % {} from about row {} on: the equipment "
                  "is another, or it is not linear",
                  output, 100 * std::abs(shift->size), shift->size < 0 ? "less" : "more", row)));
  }
}

/// One simulation from x0 at the first identification row to the last row of both ranges; rows
/// before the identification need another.
void score_outcome(const IdentifyData& data, IdentifyOutcome& outcome) {
  const Identified& identified = outcome.identified;
  const bool before = data.validate.begin < data.identify.begin;
  const RowRange run{data.identify.begin,
                     before ? data.identify.end : std::max(data.identify.end, data.validate.end)};
  warn_of_states(data, run, true, outcome.warnings);
  outcome.identify =
      score_free_run(identified.model, data.record, run, data.identify, identified.x0);
  if (before) warn_of_states(data, data.validate, false, outcome.warnings);
  outcome.diagnostics =
      before ? diagnose(identified.model, data.record, data.validate, data.validate)
             : diagnose(identified.model, data.record, run, data.validate, identified.x0);
  const identification::Matrix y_hat = free_run(identified.model, data.record, run, identified.x0);
  const RowRange validate = data.validate;
  const auto found = bends(data.record, validate,
                           before ? free_run(identified.model, data.record, validate)
                                  : y_hat.middleRows(validate.begin - run.begin, validate.size()));
  for (std::string& sentence : bend_sentences(found, data, "what the free run leaves"))
    outcome.warnings.push_back(std::move(sentence));
  warn_of_shifts(data, run, y_hat, outcome);
}

int print_rejection(const Verdict& verdict, const Arguments& arguments, const IdentifyData& data) {
  std::string advice = data.advice.empty() ? "" : "; " + data.advice;
  if (verdict.code == identification::VerdictCode::too_few_samples && !arguments.data.identify)
    advice += "; these are the first two thirds of the file: --identify 0:ROWS takes more of them";
  if (verdict.code == identification::VerdictCode::too_few_samples &&
      !arguments.model.delays.empty())
    advice += fmt::format(
        "; --delay {} takes as many rows from the begin, and those whose inputs would be in a gap",
        fmt::join(arguments.model.delays, " "));
  if (verdict.code == identification::VerdictCode::no_better_than_mean) {
    const RowRange rows = data.identify;
    const auto found =
        bends(data.record, rows, identification::Matrix::Zero(rows.size(), data.record.y.cols()));
    for (const std::string& sentence : bend_sentences(found, data, "its moves about its mean"))
      advice += "; " + sentence;
  }
  const std::vector<std::string> left_out = left_out_sentences(data);
  if (arguments.json) {
    const nlohmann::ordered_json object = {{"rejected", name(verdict.code)},
                                           {"reason", verdict.reason + advice},
                                           {"found", data.found},
                                           {"left_out", left_out_json(data)},
                                           {"warnings", data.warnings}};
    fmt::print("{}\n", object.dump());
  } else {
    print_error("reident: no model ({}): {}{}", name(verdict.code), verdict.reason, advice);
    for (const auto* sentences : {&data.warnings, &left_out})
      for (const std::string& sentence : *sentences) print_error("warning: {}", sentence);
  }
  return exit_no_model;
}

/// The request for data with all that the command line says of the file.
std::variant<DataRequest, Refusal> complete(const Arguments& arguments) {
  DataRequest request = arguments.data;
  auto reading = telemetry_file::reading_options(arguments.reading, utc_now());
  if (const auto* error = std::get_if<csv::Error>(&reading)) return Refusal{error->message};
  request.reading = std::get<telemetry_file::ReadingOptions>(std::move(reading));
  request.reading.clock_may_go_back = arguments.reading.clock_back != "stop";
  request.skip_bad_lines = arguments.reading.skip_bad_lines;
  if (arguments.phase) {
    request.phase_ns = parse_duration(*arguments.phase);
    if (!request.phase_ns || *request.phase_ns < 0)
      return Refusal{
          fmt::format("--phase {} is no duration; write it as 0, 180ms or 1s", *arguments.phase)};
  }
  if (!arguments.hold) return request;
  request.hold_ns = parse_duration(*arguments.hold);
  if (!request.hold_ns || *request.hold_ns <= 0)
    return Refusal{
        fmt::format("--hold {} is no duration; write it as 400, 400s or 10min", *arguments.hold)};
  return request;
}

int show(const DataRequest& request) {
  auto reading = request.reading;
  reading.any_epoch = true;
  reading.continues_clock = false;
  if (request.segment) reading.force_times = true;  // as in read_data()
  const auto shown = telemetry_file::dry_run(
      telemetry_file::open_as_table(request.file, reading, request.skip_bad_lines), request.file,
      reading.time.column.has_value());
  if (const auto* error = std::get_if<csv::Error>(&shown)) return refuse({error->message});
  for (const std::string& line : std::get<std::vector<std::string>>(shown))
    fmt::print("{}\n", line);
  return exit_done;
}

int run(const Arguments& arguments) {
  if (const auto refusal = refuse_arguments(arguments)) return refuse(*refusal);
  const auto request = complete(arguments);
  if (const auto* refusal = std::get_if<Refusal>(&request)) return refuse(*refusal);
  if (arguments.reading.dry_run) return show(std::get<DataRequest>(request));
  PhaseTimer timer;
  timer.begin("read");
  auto read = read_data(std::get<DataRequest>(request));
  if (const auto* refusal = std::get_if<Refusal>(&read)) return refuse(*refusal);
  auto& data = std::get<IdentifyData>(read);
  timer.end();
  IdentifyOptions options;
  if (const auto refusal = parse_model_request(arguments.model, data.inputs, data.outputs, options))
    return refuse(*refusal);

  WorkerPool workers(*threads_of(arguments));
  options.for_each = [&workers](std::size_t count, const std::function<void(std::size_t)>& task) {
    workers.for_each(count, task);
  };
  options.on_phase = [&timer](std::string_view phase) { timer.begin(phase); };
  options.input_names = data.inputs;
  options.wants_gain_uncertainty = true;
  options.regime_inputs = data.regime_inputs;
  options.output_names = data.outputs;
  auto result = arguments.data.screening
                    ? identify_explained(data, options)
                    : identification::identify(data.record, data.identify, options);
  if (const auto* verdict = std::get_if<Verdict>(&result))
    return print_rejection(*verdict, arguments, data);

  timer.begin("score");
  IdentifyOutcome outcome;
  outcome.identified = std::get<Identified>(std::move(result));
  outcome.inputs = data.inputs;
  outcome.outputs = data.outputs;
  outcome.derived = data.derived;
  outcome.regimes = data.regimes;
  outcome.regime_inputs = static_cast<std::size_t>(data.regime_inputs);
  outcome.left_out = left_out_json(data);
  outcome.warnings = left_out_sentences(data);
  outcome.warnings.insert(outcome.warnings.end(), data.warnings.begin(), data.warnings.end());
  const auto& own = outcome.identified.warnings;
  outcome.warnings.insert(outcome.warnings.end(), own.begin(), own.end());
  score_outcome(data, outcome);
  warn_of_useless_outputs(data, outcome);
  // Delays are no part of it: they would be poles at 0, which no differential equation has.
  outcome.continuous = to_continuous(
      without_delay_states(outcome.identified.model, outcome.identified.input_delays));
  timer.end();
  outcome.timing_ms = timer.phases();
  outcome.found = data.found;
  outcome.phase_ns = data.phase_ns;
  if (!arguments.json) print_error("{}: {}", arguments.data.file.string(), data.found);
  fmt::print("{}", arguments.json ? to_json_text(outcome) : to_report(outcome));
  return exit_done;
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  command.add_option("file", arguments->data.file, "CSV file with a header row; opened read-only");
  command.add_option("--input", arguments->data.inputs, "columns that drive the model");
  command.add_option("--output", arguments->data.outputs, "columns that the model computes")
      ->required();
  command
      .add_option("--derive", arguments->data.derive,
                  "NAME=EXPRESSION: an input for --input that follows from columns, such as "
                  "\"P=u*i\"; + - * / ^ ( ), comparisons, a ? b : c, abs, min, max")
      ->allow_extra_args(false);
  command
      .add_option("--regime", arguments->data.regimes,
                  "COLUMN or CONDITION, such as S_ECL or \"I_SA < 0.1\", that is 0 outside of an "
                  "operating regime: within it the inputs have gains and an offset of their own, "
                  "where held-out rows show that this helps; a column of few values has a regime "
                  "for each")
      ->allow_extra_args(false);
  command
      .add_option("--period", arguments->data.period_s,
                  "from row to row, in seconds or such as 100ms, or of the grid with --time (the "
                  "usual step of the slowest column)")
      ->type_name("DURATION")
      ->transform([](const std::string& text) {
        const bool has_unit =
            !text.empty() && std::isalpha(static_cast<unsigned char>(text.back()));
        const auto ns = has_unit ? parse_duration(text) : std::nullopt;
        return ns ? fmt::format("{:.17g}", static_cast<double>(*ns) * 1e-9) : text;
      });
  command
      .add_option(
          "--hold", arguments->hold,
          "how long a value serves, such as 400s, where it comes on change or seldom (3 periods; 1 "
          "where it comes at every tick, whatever it is)")
      ->type_name("DURATION");
  command
      .add_option("--phase", arguments->phase,
                  "how far behind the multiples of the period ticks stand (0, or where all columns "
                  "have come)")
      ->type_name("DURATION");
  command
      .add_option(
          "--segment", arguments->data.segment,
          "column whose words say which rows belong together, as the number of a test: each "
          "is a record with a state of its own")
      ->type_name("COLUMN");
  command.add_option("--identify", arguments->data.identify,
                     "rows A:B of the file, 0-based and half-open (the first two thirds)");
  command.add_option("--validate", arguments->data.validate,
                     "rows C:D to score on (those after the identification rows)");
  command.add_flag("!--no-screening", arguments->data.screening,
                   "keep rows at which a column shows a fault (a fill value, a stuck sensor, a "
                   "spike, a burst of noise), an output's outliers and rows at its limits, and "
                   "an input's that the outputs hardly follow");
  add_model_options(command, arguments->model);
  add_reading_options(command, arguments->reading);
  command.add_option("--threads", arguments->threads,
                     "threads of the search, which finds the same with any number of them (one "
                     "for each core)");
  command.add_flag("--json", arguments->json, "one JSON object with matrices, x0 and errors");
  command.footer(
      "Example:\n"
      "  reident identify dryer.csv --input u1 --output y1 --identify 0:500 --validate 500:1000\n"
      "Exit status: 2 for an impossible request, 3 when the data give no model.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"identify", "Identify a state-space model from a CSV file and score it on other rows",
     WorksOn::files, declare});

}  // namespace

}  // namespace reident::cli::identify_verb
