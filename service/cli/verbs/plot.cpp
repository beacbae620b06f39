#include <cerrno>
#include <cstdio>
#include <fstream>
#include <memory>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/history_access.hpp"
#include "service/cli/output/model_picture.hpp"
#include "service/cli/output/record_picture.hpp"
#include "service/cli/output/stored_version.hpp"
#include "service/cli/range_options.hpp"
#include "service/cli/replace_option.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/operations/commands.hpp"
#include "service/review/evidence.hpp"
#include "service/review/stored_league.hpp"
#include "service/support/terminal.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli::plot_verb {
namespace {

using nlohmann::ordered_json;

struct Arguments {
  HistoryAccessOptions access;
  std::string subject;
  std::optional<std::string> output;
  std::optional<std::int64_t> with;
  bool record = false;
  bool replace = false;
  RangeOptions range;
};

/// Those of which something is in the picture.
std::vector<PicturePart> parts_of(const StoredVersion& story, storage::TimeRange shown) {
  std::vector<PicturePart> parts = {{"identify", story.model.identified_from}};
  if (const auto tune = tuned_on(story.version)) parts.push_back({"tune", *tune});
  parts.push_back({"validate", story.model.validated_on});
  const auto evidence = evidence_of(story.attempt);
  const auto longest =
      evidence.value(ordered_json::json_pointer("/implausible/longest"), ordered_json::array());
  for (const ordered_json& range : longest)
    parts.push_back(
        {"excluded",
         {range.value("begin_ns", std::int64_t{0}), range.value("end_ns", std::int64_t{0})}});
  std::erase_if(parts, [shown](const PicturePart& part) {
    return part.range.end <= shown.begin || part.range.begin >= shown.end ||
           part.range.end <= part.range.begin;
  });
  return parts;
}

std::vector<double> singular_values_of(const storage::Attempt& attempt) {
  std::vector<double> values;
  const ordered_json evidence = evidence_of(attempt);
  const auto found = evidence.find("singular_values");
  if (found == evidence.end() || !found->is_array()) return values;
  for (const ordered_json& value : *found)
    if (value.is_number()) values.push_back(value.get<double>());
  return values;
}

/// The run of another version of the same equipment and outputs.
std::variant<PictureData::Other, Refusal> other_run(const Readers& readers,
                                                    const StoredVersion& story, std::int64_t number,
                                                    storage::TimeRange shown) {
  const storage::Version& version = story.version;
  auto found =
      find_stored_version(readers.history, {version.spacecraft, version.equipment, number});
  if (const auto* refusal = std::get_if<Refusal>(&found)) return *refusal;
  const EquipmentModel& model = std::get<StoredVersion>(found).model;
  if (signal_names(model.outputs) != signal_names(story.model.outputs))
    return Refusal{fmt::format("version {} has other outputs than version {}; name another one",
                               number, version.number)};
  auto run = run_model(readers.telemetry, model, shown, shown.begin);
  if (const auto* reason = std::get_if<std::string>(&run)) return Refusal{*reason};
  return PictureData::Other{fmt::format("version {}", number), std::get<ModelRun>(std::move(run))};
}

/// Since when the equipment is another, as the champion's record shows.
std::optional<storage::Time> change_of(const history::HistoryReader& history,
                                       const storage::EquipmentName& name) {
  for (const history::OverviewRow& row : history.overview())
    if (row.name == name && row.change) return row.change->since;
  return std::nullopt;
}

std::variant<std::string, Refusal> picture_of(const Readers& readers, const StoredVersion& story,
                                              const Arguments& arguments) {
  const auto range = range_of(arguments.range, story.version.window);
  if (const auto* refusal = std::get_if<Refusal>(&range)) return *refusal;
  const auto& shown = std::get<storage::TimeRange>(range);
  const auto run = run_model(readers.telemetry, story.model, shown, shown.begin);
  if (const auto* reason = std::get_if<std::string>(&run)) return Refusal{*reason};
  const storage::Version& version = story.version;
  PictureData data{
      .title = fmt::format("{} version {}", full_name({version.spacecraft, version.equipment}),
                           version.number),
      .subtitle = fmt::format("{}; {}; {} to {}", version.status, story.model.method,
                              time_text(shown.begin), time_text(shown.end)),
      .model = story.model,
      .run = std::get<ModelRun>(run),
      .range = shown,
      .parts = parts_of(story, shown),
      .singular_values = singular_values_of(story.attempt),
      .change = change_of(readers.history, {version.spacecraft, version.equipment})};
  if (arguments.with) {
    auto other = other_run(readers, story, *arguments.with, shown);
    if (const auto* refusal = std::get_if<Refusal>(&other)) return *refusal;
    data.other = std::get<PictureData::Other>(std::move(other));
  }
  return model_picture(data);
}

std::variant<std::string, Refusal> picture_of_record(const history::HistoryReader& history,
                                                     const StoredVersion& story) {
  const storage::Version& version = story.version;
  const std::string title = fmt::format(
      "{} version {}", full_name({version.spacecraft, version.equipment}), version.number);
  const auto record = stored_record(history, story);
  if (!record)
    return Refusal{title +
                   " has no record beside a champion: it was the first version, was refused "
                   "at its window, or waits for its first block"};
  RecordPictureData data{
      .title = title + fmt::format(" beside version {}", record->league.champion->version),
      .subtitle = version.status,
      .blocks =
          Judge(record->limits).compared_blocks(record->league, record->member(version.number)),
      .change = record->change};
  if (data.blocks.empty())
    return Refusal{title + " and its champion have no block in common since the last change"};
  return record_picture(data);
}

int write_picture(const std::string& picture, const std::string& path) {
  if (path == "-") {
    fmt::print("{}", picture);
    return exit_done;
  }
  errno = 0;
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << picture;
  file.close();
  if (!file) {
    print_error("reident: {} cannot be written: {}", path, std::generic_category().message(errno));
    return exit_failed;
  }
  fmt::print("{}\n", path);
  return exit_done;
}

int run(const Arguments& arguments) {
  return with_version(
      arguments.access, arguments.subject, [&](const Readers& readers, const StoredVersion& story) {
        const std::string path = arguments.output.value_or(
            fmt::format("{}-v{}.svg", story.version.equipment, story.version.number));
        if (const auto refusal = exists_already(path, arguments.replace)) return refuse(*refusal);
        const auto picture = arguments.record ? picture_of_record(readers.history, story)
                                              : picture_of(readers, story, arguments);
        if (const auto* refusal = std::get_if<Refusal>(&picture)) return refuse(*refusal);
        return write_picture(std::get<std::string>(picture), path);
      });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_version_argument(command, arguments->subject);
  command.add_option("-o,--output", arguments->output,
                     "file to write, - for standard output (EQUIPMENT-vVERSION.svg)");
  add_replace_option(command, arguments->replace);
  command.add_flag("--record", arguments->record,
                   "draw its record beside the champion's instead: scores, mean, lower confidence "
                   "bound, change");
  command.add_option("--with", arguments->with, "number of another version, drawn too")
      ->check(above_zero());
  add_range_options(command, arguments->range, "the window of the version");
  for (const char* option : {"--with", "--begin", "--end"})
    command.get_option(option)->excludes("--record");
  add_access_options(command, arguments->access);
  command.footer("Example:\n  reident plot CBERS-4/BDR@3 -o bdr3.svg --config reident.toml");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"plot", "Draw a version: outputs measured and simulated, errors, inputs, poles (SVG)",
     WorksOn::history, declare});

}  // namespace

}  // namespace reident::cli::plot_verb
