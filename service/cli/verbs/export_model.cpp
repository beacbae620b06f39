#include <csignal>
#include <filesystem>
#include <functional>

#include <fmt/format.h>

#include "service/cli/history_access.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/range_options.hpp"
#include "service/cli/replace_option.hpp"
#include "service/cli/verb.hpp"
#include "service/model_export/model_export.hpp"
#include "service/operations/commands.hpp"
#include "service/review/model_state.hpp"
#include "service/support/output_file.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::export_model_verb {
namespace {

using model_export::ExportedVersion;
using model_export::FmiVersion;

constexpr const char* standard_output = "-";

struct Arguments {
  HistoryAccessOptions access;
  std::string subject;
  std::optional<std::string> fmu, fmu3, mat, json;
  std::optional<std::string> at;
  bool replace = false;
};

/// A file to be written.
struct Target {
  std::string path;
  std::string_view what;
  std::function<std::string(const ExportedVersion&)> content;
};

std::vector<Target> targets_of(const Arguments& arguments) {
  std::vector<Target> targets;
  const auto fmu = [](FmiVersion fmi) {
    return [fmi](const ExportedVersion& exported) {
      return model_export::fmu_file(exported, fmi, model_export::fmu_parts());
    };
  };
  if (arguments.fmu) targets.push_back({*arguments.fmu, "FMU (FMI 2.0)", fmu(FmiVersion::two)});
  if (arguments.fmu3) targets.push_back({*arguments.fmu3, "FMU (FMI 3.0)", fmu(FmiVersion::three)});
  if (arguments.mat) targets.push_back({*arguments.mat, "MATLAB file", model_export::mat_file});
  if (arguments.json) targets.push_back({*arguments.json, "JSON", model_export::json_file});
  return targets;
}

/// What is wrong with the files that are asked for.
std::optional<Refusal> mistake_in(const std::vector<Target>& targets, bool replace) {
  if (targets.empty())
    return Refusal{"nothing to write; name a file with --fmu, --fmu3, --mat or --json"};
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Target& target = targets[i];
    if (target.path == standard_output) {
      if (target.what == "JSON") continue;
      return Refusal{fmt::format("the {} cannot go to standard output; name a file", target.what)};
    }
    for (std::size_t k = 0; k < i; ++k)
      if (targets[k].path == target.path)
        return Refusal{fmt::format("{} is named twice; each kind needs a file", target.path)};
    if (auto refusal = exists_already(target.path, replace)) return refusal;
  }
  return std::nullopt;
}

std::variant<ExportedVersion, Refusal> exported_version(StoredVersion story) {
  ExportedVersion exported;
  exported.status = story.version.status;
  ModelVersion& version = exported.version;
  version.model = std::move(story.model);
  version.number = story.version.number;
  version.digest = story.version.digest;
  version.program_version = story.attempt.program_version;
  if (!story.decisions.empty()) {
    version.decided = story.decisions.back().time;
    version.decided_by = story.decisions.back().actor;
  }
  if (const auto reason = model_export::obstacle(version))
    return Refusal{fmt::format("{} version {} cannot be exported: {}",
                               full_name({version.model.spacecraft, version.model.equipment}),
                               version.number, *reason)};
  return exported;
}

OutputFile output_to(const std::string& path, bool replace) {
  if (path == standard_output) return OutputFile::standard_output();
  return OutputFile(path, replace ? OutputFile::Existing::replaced : OutputFile::Existing::kept);
}

/// No file takes its name before all of them are written.
void write(const ExportedVersion& exported, const std::vector<Target>& targets, bool replace) {
  std::vector<OutputFile> files;
  for (const Target& target : targets) {
    const std::string content = target.content(exported);
    files.push_back(output_to(target.path, replace));
    files.back().write(content);
  }
  for (OutputFile& file : files) file.finish();
}

void print_done(const ExportedVersion& exported, const std::vector<Target>& targets) {
  const ModelVersion& version = exported.version;
  for (const Target& target : targets)
    fmt::print("{}: {} of {} version {}\n", target.path, target.what,
               full_name({version.model.spacecraft, version.model.equipment}), version.number);
  if (exported.start)
    fmt::print("a simulation begins in the state of {}\n", time_text(exported.start->time));
}

int run(const Arguments& arguments) {
  std::signal(SIGPIPE, SIG_IGN);
  const std::vector<Target> targets = targets_of(arguments);
  if (const auto refusal = mistake_in(targets, arguments.replace)) return refuse(*refusal);
  storage::Time at = 0;
  if (auto refusal = read_telemetry_time("--at", arguments.at, at)) return refuse(*refusal);
  return with_version(arguments.access, arguments.subject,
                      [&](const Readers& readers, StoredVersion&& story) {
                        auto made = exported_version(std::move(story));
                        if (const auto* refusal = std::get_if<Refusal>(&made))
                          return refuse(*refusal);
                        auto& exported = std::get<ExportedVersion>(made);
                        if (arguments.at) {
                          auto state = state_at(readers.telemetry, exported.version.model, at);
                          if (const auto* reason = std::get_if<std::string>(&state))
                            return refuse(Refusal{"no state for --at: " + *reason});
                          auto& [time, x] = std::get<ModelState>(state);
                          exported.start = {time, std::move(x)};
                        }
                        write(exported, targets, arguments.replace);
                        if (arguments.json != standard_output) print_done(exported, targets);
                        return static_cast<int>(exit_done);
                      });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_version_argument(command, arguments->subject);
  command.add_option("--fmu", arguments->fmu, "FMU for co-simulation, FMI 2.0");
  command.add_option("--fmu3", arguments->fmu3, "FMU for co-simulation, FMI 3.0");
  command.add_option("--mat", arguments->mat, "MATLAB file, version 5");
  command.add_option("--json", arguments->json, "JSON; - is standard output");
  command.add_option("--at", arguments->at,
                     "a simulation begins in the state of this time, estimated from the telemetry "
                     "before it; otherwise at rest at the operating point");
  add_replace_option(command, arguments->replace);
  add_access_options(command, arguments->access);
  command.footer(
      "Of several no file takes its name before all of them are written.\n"
      "Example:\n"
      "  reident export-model CBERS-4/BDR@3 --fmu bdr.fmu --mat bdr.mat --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered({"export-model", "Write a version as FMU, MATLAB file or JSON",
                                   WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::export_model_verb
