#include "service/cli/identify_options.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace reident::cli {
namespace {

using identification::IdentifyOptions;

constexpr int max_order = 100;
constexpr int max_horizon = 500;
constexpr int max_delay = 1000;

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

/// Inputs that are not named have the delay 0.
std::optional<Refusal> parse_delays(const std::vector<std::string>& delays,
                                    const std::vector<std::string>& inputs,
                                    IdentifyOptions& options) {
  std::vector<std::optional<int>> found(inputs.size());
  for (const std::string& text : delays) {
    const std::size_t equals = text.rfind('=');
    const std::string name = text.substr(0, equals);
    const auto samples =
        equals == std::string::npos ? std::nullopt : whole_number(text.substr(equals + 1));
    if (!samples || *samples > max_delay)
      return Refusal{
          fmt::format("--delay {} is no delay; write it as INPUT=SAMPLES, with whole "
                      "samples from 0 to {}",
                      text, max_delay)};
    const auto input = std::find(inputs.begin(), inputs.end(), name);
    if (input == inputs.end())
      return Refusal{fmt::format("--delay names {}, which is no input; inputs: {}", name,
                                 fmt::join(inputs, ", "))};
    std::optional<int>& delay = found[static_cast<std::size_t>(input - inputs.begin())];
    if (delay) return Refusal{fmt::format("--delay names {} twice; give it one delay", name)};
    delay = static_cast<int>(*samples);
  }
  for (const std::optional<int>& delay : found) options.input_delays.push_back(delay.value_or(0));
  return std::nullopt;
}

}  // namespace

void add_model_options(CLI::App& command, ModelRequest& request) {
  command.add_option("--order", request.order, "auto or the number of states")
      ->capture_default_str();
  command.add_option("--horizon", request.horizon, "auto or the number of block rows")
      ->capture_default_str();
  CLI::Option* direct =
      command.add_flag("--direct", request.direct, "inputs act on outputs of the same row (D)");
  command.add_flag("--no-direct", request.no_direct, "D is zero; without either the data decide")
      ->excludes(direct);
  command.add_flag("--as-found", request.as_found,
                   "refuse unstable models instead of making A stable, which costs some bias");
  CLI::Option* delays = command.add_option(
      "--delay", request.delays, "INPUT=SAMPLES...: rows after which an input begins to act");
  command
      .add_option(
          "--max-delay", request.max_delay,
          "look for delays of the inputs of at most so many rows; 0: for none (as long as the "
          "rows show; none with --order or --delay)")
      ->excludes(delays);
}

std::optional<Refusal> parse_model_request(const ModelRequest& request,
                                           const std::vector<std::string>& inputs,
                                           const std::vector<std::string>& outputs,
                                           IdentifyOptions& options) {
  if (auto refusal = parse_choice("--order", request.order, 0, max_order, options.order))
    return refusal;
  if (auto refusal = parse_choice("--horizon", request.horizon, 2, max_horizon, options.horizon))
    return refusal;
  const auto p = static_cast<int>(outputs.size());
  if (options.order && options.horizon && *options.order > p * (*options.horizon - 1))
    return Refusal{fmt::format("--horizon {} is too short for --order {}; make it at least {}",
                               *options.horizon, *options.order, (*options.order + p - 1) / p + 1)};
  if (request.direct || request.no_direct) options.direct_feedthrough = request.direct;
  options.may_enforce_stability = !request.as_found;
  if (!options.order && request.delays.empty()) options.max_input_delay = std::nullopt;
  if (request.max_delay) {
    const std::optional<std::int64_t> value = whole_number(*request.max_delay);
    if (!value || *value > max_delay)
      return Refusal{fmt::format("--max-delay {} is no whole number of rows from 0 to {}",
                                 *request.max_delay, max_delay)};
    options.max_input_delay = static_cast<int>(*value);
  }
  if (request.delays.empty()) return std::nullopt;
  return parse_delays(request.delays, inputs, options);
}

}  // namespace reident::cli
