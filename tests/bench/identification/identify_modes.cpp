#include <cstdio>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "identification/identify.hpp"
#include "service/model/model_json.hpp"
#include "tests/bench/identification/measure.hpp"
#include "tests/bench/identification/modes.hpp"

namespace reident::bench {
namespace {

using identification::Identified;
using identification::IdentifyOptions;
using identification::Record;
using identification::StateSpaceModel;
using identification::Verdict;
using identification::Weighting;

struct Arguments {
  std::filesystem::path file;
  IdentifyOptions options;
  int repeats = 1;
};

Identified identified(const Record& record, const IdentifyOptions& options) {
  auto result = identification::identify(record, record.all(), options);
  if (const auto* verdict = std::get_if<Verdict>(&result))
    throw std::runtime_error(verdict->reason);
  return std::get<Identified>(std::move(result));
}

void run(const Arguments& given) {
  const Record record = read_record(given.file);
  Identified result;
  const Measurement measured =
      measure(given.repeats, [&] { result = identified(record, given.options); });
  const StateSpaceModel& model = result.model;
  const nlohmann::ordered_json text = {{"order", model.order()},
                                       {"horizon", result.horizon},
                                       {"weighting", name(result.weighting)},
                                       {"A", to_json(model.A)},
                                       {"B", to_json(model.B)},
                                       {"C", to_json(model.C)},
                                       {"D", to_json(model.D)},
                                       {"K", to_json(model.K)},
                                       {"x0", to_json(result.x0)},
                                       {"input_offset", to_json(model.u0)},
                                       {"output_offset", to_json(model.y0)},
                                       {"singular_values", to_json(result.singular_values)},
                                       {"ms", measured.ms},
                                       {"peak_extra_mib", measured.peak_extra_mib}};
  std::printf("%s\n", text.dump().c_str());
}

CLI::App* add_mode(CLI::App& app, const std::string& mode, const std::string& description,
                   const std::shared_ptr<Arguments>& given) {
  CLI::App* added = app.add_subcommand(mode, description);
  added->add_option("file", given->file, "file of samples")->required();
  added->add_option("--repeats", given->repeats, "timed repeats")->check(CLI::PositiveNumber);
  added->callback([given] { run(*given); });
  return added;
}

}  // namespace

void add_identify(CLI::App& app) {
  const auto fixed = std::make_shared<Arguments>();
  fixed->options.order = 0;
  fixed->options.horizon = 0;
  fixed->options.weighting = Weighting::n4sid;
  CLI::App* one_shot = add_mode(
      app, "one-shot", "One identification of fixed order, horizon and N4SID weighting", fixed);
  one_shot->add_option("--order", *fixed->options.order)->required()->check(CLI::PositiveNumber);
  one_shot->add_option("--horizon", *fixed->options.horizon)->required()->check(CLI::Range(2, 500));
  add_mode(app, "automatic", "One identification that chooses order, horizon and weighting",
           std::make_shared<Arguments>());
}

}  // namespace reident::bench
