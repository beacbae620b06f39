#include "service/sweep/plan.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "service/config/config_changes.hpp"
#include "service/operations/backfill.hpp"
#include "service/support/output_file.hpp"
#include "service/support/sha256.hpp"
#include "service/support/version.hpp"
#include "service/sweep/task_file.hpp"
#include "storage/care/backup.hpp"

namespace reident::sweep {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using storage::Database;

/// Slurm's arrays have at most 1001 tasks unless a site allows more.
constexpr std::size_t most_tasks = 1000;
/// A task takes a second or more, so that its start does not count.
constexpr std::size_t least_windows_of_task = 8;

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument(why);
}

fs::path plan_file(const fs::path& folder) {
  return folder / "plan.json";
}

fs::path configuration_file(const fs::path& folder, std::size_t number) {
  return folder / fmt::format("configuration-{}.toml", number);
}

[[noreturn]] void refuse(const fs::path& file, const std::vector<ConfigMistake>& mistakes) {
  std::string text;
  for (const ConfigMistake& mistake : mistakes)
    text += fmt::format("{}{}{}: {}", text.empty() ? "" : "; ", file.string(),
                        mistake.line == 0 ? "" : fmt::format(":{}", mistake.line), mistake.message);
  refuse(text);
}

Config loaded(const fs::path& file) {
  auto config = load_config(file);
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&config))
    refuse(file, *mistakes);
  return std::get<Config>(std::move(config));
}

/// Writes the changed configuration; one that is there has to be the same.
void put_configuration(const Question& question, const fs::path& folder, std::size_t number,
                       const std::function<bool()>& go_on) {
  const fs::path& file = question.configurations[number];
  fs::path database = fs::absolute(loaded(file).database);
  if (question.copy) {
    const fs::path copy = fs::absolute(folder) / fmt::format("archive-{}.db", number);
    if (!fs::exists(copy)) {
      Database archive(database, Database::Mode::read_only);
      if (!back_up(archive, copy, {}, [&](const storage::BackupProgress&) { return go_on(); }))
        refuse("stopped; the same command goes on where it ended");
    }
    database = copy;
  }
  const auto changed = changed_config(file, {.database = database, .equipment = question.changes});
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&changed))
    refuse(file, *mistakes);
  OutputFile output(configuration_file(folder, number));
  output.write(std::get<std::string>(changed));
  output.finish();
}

/// The range of the windows' ends, none of which lies behind the telemetry of now.
storage::TimeRange range_of(const storage::Archive& archive, const std::string& spacecraft,
                            storage::TimeRange wanted) {
  const auto extent = archive.extent(spacecraft, storage::Origin::real);
  if (!extent) return {wanted.begin, wanted.begin};
  return {std::max(wanted.begin, extent->begin), std::min(wanted.end, extent->end)};
}

struct Windows {
  std::size_t spacecraft;
  const std::string& equipment;
  std::vector<storage::Time> ends;  // ascending
};

/// The windows of each equipment in pieces that follow each other, about as large as each other.
std::vector<CandidateTask> cut(const std::vector<Windows>& equipment) {
  std::size_t windows = 0;
  for (const Windows& one : equipment) windows += one.ends.size();
  const std::size_t parts = most_tasks - std::min(most_tasks - 1, equipment.size());
  const std::size_t size = std::max(least_windows_of_task, (windows + parts - 1) / parts);
  std::vector<CandidateTask> tasks;
  for (const auto& [spacecraft, name, ends] : equipment)
    for (std::size_t begin = 0; begin < ends.size(); begin += size) {
      const std::size_t end = std::min(ends.size(), begin + size);
      tasks.push_back({spacecraft, name, {ends[begin], ends[end - 1]}, end - begin});
    }
  return tasks;
}

void plan_tasks(Plan& plan, const Question& question) {
  std::vector<Windows> equipment;
  std::set<std::string> names;
  for (std::size_t i = 0; i < plan.configurations.size(); ++i) {
    const Config& config = plan.configurations[i];
    Database database(config.database, Database::Mode::read_only);
    const storage::Archive archive(database);
    for (const SpacecraftConfig& one : config.spacecraft) {
      if (!names.insert(one.name).second)
        refuse(fmt::format("two configurations have the spacecraft {}; leave one out", one.name));
      const storage::TimeRange range = range_of(archive, one.name, question.range);
      for (const EquipmentConfig& of_one : one.equipment) {
        try {
          equipment.push_back(
              {plan.spacecraft.size(), of_one.name, window_ends(archive, one.name, of_one, range)});
        } catch (const storage::Error& error) {
          throw storage::Error(error.kind(),
                               fmt::format("{}; or leave {} out of {}", error.what(), of_one.name,
                                           question.configurations[i].string()));
        }
      }
      plan.spacecraft.push_back({one.name, i, range});
    }
  }
  plan.candidates = cut(equipment);
  if (plan.candidates.empty())
    refuse(
        "there is no window to try: the archives hold no telemetry of the configured equipment "
        "in that time; widen --from and --to");
}

ordered_json to_json(storage::TimeRange range) {
  return {range.begin, range.end};
}

storage::TimeRange range_from(const ordered_json& json) {
  return {json.at(0).get<storage::Time>(), json.at(1).get<storage::Time>()};
}

ordered_json to_json(const Plan& plan, const Question& question) {
  ordered_json json = {{"format", 1},
                       {"program_version", plan.program_version},
                       {"range", to_json(question.range)},
                       {"configurations", ordered_json::array()},
                       {"spacecraft", ordered_json::array()},
                       {"candidates", ordered_json::array()}};
  for (const Config& config : plan.configurations) json["configurations"].push_back(config.digest);
  for (const PlannedSpacecraft& one : plan.spacecraft)
    json["spacecraft"].push_back(
        {{"name", one.name}, {"configuration", one.configuration}, {"range", to_json(one.range)}});
  for (const CandidateTask& task : plan.candidates)
    json["candidates"].push_back({{"spacecraft", task.spacecraft},
                                  {"equipment", task.equipment},
                                  {"range", to_json(task.range)},
                                  {"windows", task.windows}});
  return json;
}

void refuse_another_question(const Plan& plan, const Question& question, const ordered_json& json) {
  bool same = range_from(json.at("range")) == question.range &&
              plan.configurations.size() == question.configurations.size();
  for (std::size_t i = 0; same && i < plan.configurations.size(); ++i) {
    const auto changed = changed_config(
        question.configurations[i],
        {.database = plan.configurations[i].database, .equipment = question.changes});
    const auto* text = std::get_if<std::string>(&changed);
    same = text != nullptr && sha256_hex(*text) == plan.configurations[i].digest;
  }
  if (!same)
    refuse(
        fmt::format("{} holds another sweep: name another folder, or leave the question out to "
                    "go on with that one",
                    plan.folder.string()));
}

}  // namespace

fs::path Plan::file_of_candidates(std::size_t task) const {
  return folder / "candidates" / fmt::format("{}.json", task);
}

fs::path Plan::file_of_judgement(std::size_t number) const {
  return folder / "judged" / (spacecraft[number].name + ".json");
}

fs::path Plan::registry_of(std::size_t number) const {
  return folder / "judged" / (spacecraft[number].name + ".db");
}

Plan make_plan(const Question& question, const fs::path& folder,
               const std::function<bool()>& go_on) {
  if (fs::exists(plan_file(folder))) {
    Plan plan = read_plan(folder);
    refuse_another_question(plan, question, *read_task_file(plan_file(folder)));
    return plan;
  }
  if (fs::is_regular_file(folder))
    refuse(fmt::format("{} is a file: name a folder for the sweep", folder.string()));
  for (const char* part : {"candidates", "judged", "failed"}) fs::create_directories(folder / part);
  Plan plan;
  plan.folder = fs::canonical(folder);
  plan.program_version = program_version();
  for (std::size_t i = 0; i < question.configurations.size(); ++i) {
    put_configuration(question, plan.folder, i, go_on);
    plan.configurations.push_back(loaded(configuration_file(plan.folder, i)));
  }
  plan_tasks(plan, question);
  write_task_file(plan_file(folder), to_json(plan, question));
  return read_plan(folder);
}

Plan read_plan(const fs::path& folder) {
  const auto json = read_task_file(plan_file(folder));
  if (!json && fs::exists(plan_file(folder)))
    refuse(
        fmt::format("{} is damaged: remove it and give the question again; the results that are "
                    "there count where the plan is the same",
                    plan_file(folder).string()));
  if (!json)
    refuse(fmt::format("{} holds no sweep: begin one with --config FILE", folder.string()));
  Plan plan;
  plan.folder = fs::canonical(folder);
  plan.digest = sha256_hex(json->dump());
  plan.program_version = json->at("program_version").get<std::string>();
  for (const ordered_json& digest : json->at("configurations")) {
    const fs::path file = configuration_file(plan.folder, plan.configurations.size());
    plan.configurations.push_back(loaded(file));
    if (plan.configurations.back().digest != digest.get<std::string>())
      refuse(
          fmt::format("{} was changed since the sweep was planned: begin again in another folder",
                      file.string()));
  }
  for (const ordered_json& one : json->at("spacecraft"))
    plan.spacecraft.push_back({one.at("name").get<std::string>(),
                               one.at("configuration").get<std::size_t>(),
                               range_from(one.at("range"))});
  for (const ordered_json& one : json->at("candidates"))
    plan.candidates.push_back({one.at("spacecraft").get<std::size_t>(),
                               one.at("equipment").get<std::string>(), range_from(one.at("range")),
                               one.at("windows").get<std::size_t>()});
  return plan;
}

}  // namespace reident::sweep
