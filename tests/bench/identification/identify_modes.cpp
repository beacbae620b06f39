#include <cstdio>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "identification/search/identify.hpp"
#include "service/model/model_json.hpp"
#include "tests/bench/identification/measure.hpp"
#include "tests/bench/identification/modes.hpp"

namespace reident::bench {
namespace {

using identification::Identified;
using identification::IdentifyOptions;
using identification::Index;
using identification::LagSums;
using identification::Record;
using identification::ResponseFit;
using identification::RowRange;
using identification::StateSpaceModel;
using identification::Verdict;
using identification::Weighting;

struct Arguments {
  std::filesystem::path file;
  IdentifyOptions options;
  int repeats = 1;
};

struct SlideArguments : Arguments {
  Index window = 0, step = 0;
};

Identified identified(const Record& record, RowRange rows, const IdentifyOptions& options,
                      LagSums* kept) {
  auto result = identification::identify(record, rows, options, kept);
  if (const auto* verdict = std::get_if<Verdict>(&result))
    throw std::runtime_error(verdict->reason);
  return std::get<Identified>(std::move(result));
}

void print(const Identified& result, const Measurement& measured) {
  const StateSpaceModel& model = result.model;
  const nlohmann::ordered_json text = {{"order", model.order()},
                                       {"horizon", result.recipe.horizon},
                                       {"weighting", name(result.recipe.weighting)},
                                       {"A", to_json(model.A)},
                                       {"B", to_json(model.B)},
                                       {"C", to_json(model.C)},
                                       {"D", to_json(model.D)},
                                       {"K", to_json(model.K)},
                                       {"x0", to_json(result.x0)},
                                       {"input_offset", to_json(model.u0)},
                                       {"output_offset", to_json(model.y0)},
                                       {"singular_values", to_json(result.singular_values)},
                                       {"cpu_ms", measured.cpu_ms},
                                       {"wall_ms", measured.wall_ms},
                                       {"peak_extra_mib", measured.peak_extra_mib}};
  std::printf("%s\n", text.dump().c_str());
}

void run(const Arguments& given) {
  const Record record = read_record(given.file);
  Identified result;
  const Measurement measured = measure(
      given.repeats, [&] { result = identified(record, record.all(), given.options, nullptr); });
  print(result, measured);
}

/// The first window fills the statistics; each refresh after it is one call that is measured.
void run_slide(const SlideArguments& given) {
  const Record record = read_record(given.file);
  const Index needed = given.window + given.step * (given.repeats + 1);
  if (record.rows() < needed)
    throw std::runtime_error("these windows need " + std::to_string(needed) +
                             " rows and the file has " + std::to_string(record.rows()));
  LagSums kept({record.u.cols() + record.y.cols(), block_rows_needed(given.options), given.step});
  RowRange rows{0, given.window};
  Identified result = identified(record, rows, given.options, &kept);
  const Measurement measured = measure(given.repeats, [&] {
    kept.forget({rows.begin, rows.begin + given.step});
    rows = {rows.begin + given.step, rows.end + given.step};
    result = identified(record, rows, given.options, &kept);
  });
  print(result, measured);
}

/// What is fixed: nothing is left to choose.
CLI::App* add_fixed(CLI::App& app, const std::string& mode, const std::string& description,
                    Arguments& given) {
  given.options.order = 0;
  given.options.horizon = 0;
  given.options.weighting = Weighting::n4sid;
  given.options.direct_feedthrough = true;
  given.options.response_fit = ResponseFit::simulation;
  CLI::App* added = app.add_subcommand(mode, description);
  added->add_option("--order", *given.options.order)->required()->check(CLI::PositiveNumber);
  added->add_option("--horizon", *given.options.horizon)->required()->check(CLI::Range(2, 500));
  added->add_option("--weighting", *given.options.weighting)
      ->transform(CLI::CheckedTransformer(std::map<std::string, Weighting>{
          {"n4sid", Weighting::n4sid}, {"moesp", Weighting::moesp}, {"cva", Weighting::cva}}));
  added->add_option("--response", *given.options.response_fit, "what B and D are fitted to")
      ->transform(CLI::CheckedTransformer(std::map<std::string, ResponseFit>{
          {"simulation", ResponseFit::simulation}, {"subspace", ResponseFit::subspace}}));
  return added;
}

void add_common(CLI::App& mode, Arguments& given) {
  mode.add_option("file", given.file, "file of samples")->required();
  mode.add_option("--repeats", given.repeats, "timed repeats")->check(CLI::PositiveNumber);
}

}  // namespace

void add_identify(CLI::App& app) {
  const auto one_shot = std::make_shared<Arguments>();
  CLI::App* mode = add_fixed(app, "one-shot",
                             "One identification of fixed order, horizon and weighting", *one_shot);
  add_common(*mode, *one_shot);
  mode->callback([one_shot] { run(*one_shot); });

  const auto slide = std::make_shared<SlideArguments>();
  mode = add_fixed(app, "slide",
                   "The same on a window that slides over the file, from statistics that are kept",
                   *slide);
  add_common(*mode, *slide);
  mode->add_option("--window", slide->window, "rows")->required()->check(CLI::PositiveNumber);
  mode->add_option("--step", slide->step, "rows")->required()->check(CLI::PositiveNumber);
  mode->callback([slide] { run_slide(*slide); });

  const auto automatic = std::make_shared<Arguments>();
  mode = app.add_subcommand(
      "automatic", "One identification that chooses order, horizon, weighting and way of B and D");
  add_common(*mode, *automatic);
  mode->callback([automatic] { run(*automatic); });
}

}  // namespace reident::bench
