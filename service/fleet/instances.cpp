#include "service/fleet/instances.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <tuple>

#include <fmt/format.h>

#include "service/config/config.hpp"
#include "service/config/fleet_table.hpp"
#include "service/fleet/site_files.hpp"
#include "service/history/stored_readers.hpp"

namespace reident::fleet {
namespace {

namespace fs = std::filesystem;

/// Absent for the table of a site.
std::optional<Instance> read_instance(const fs::path& file) {
  Instance instance;
  instance.name = file.stem().string();
  instance.is_of_site = is_of_table(file);
  const auto loaded = load_config(file);
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded)) {
    if (std::holds_alternative<Fleet>(load_fleet(file))) return std::nullopt;
    instance.problem = file.string() + ": " + mistakes->front().message;
    instance.is_of_site = true;
    return instance;
  }
  const Config& config = std::get<Config>(loaded);
  std::error_code unknown;
  instance.has_service = false;
  if (!fs::exists(config.database, unknown) && !unknown) {
    instance.problem = fmt::format(
        "database {} is not there: start the service, which makes it, or check the path",
        config.database.string());
    return instance;
  }
  instance.is_of_site = true;
  instance.has_service = storage::Database::has_writer(config.database);
  try {
    storage::Database database(config.database, storage::Database::Mode::read_only);
    const history::StoredHistory history(database);
    instance.rows = history.overview();
    instance.alarms = history.alarms();
  } catch (const std::exception& error) {
    instance.problem = error.what();
    return instance;
  }
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      history::add_untried({spacecraft.name, equipment.name}, instance.rows);
  history::put_worst_first(instance.rows, instance.alarms);
  return instance;
}

}  // namespace

std::size_t Instance::with_champion() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(rows, [](const auto& row) { return row.champion > 0; }));
}

std::optional<storage::Time> Instance::oldest_telemetry() const {
  std::optional<storage::Time> oldest;
  for (const history::OverviewRow& row : rows)
    if (row.telemetry && (!oldest || *row.telemetry < *oldest)) oldest = row.telemetry;
  return oldest;
}

std::string Instance::note() const {
  if (!is_of_site) return "never started, and in no table of the site";
  if (!problem.empty()) return problem;
  const std::string stopped =
      has_service.value_or(true) ? ""
                                 : fmt::format("stopped: journalctl -u reidentd@{} says why", name);
  for (const storage::Alarm& alarm : alarms)
    if (alarm.acknowledged_by.empty())
      return fmt::format("{}{}{}: {}", stopped, stopped.empty() ? "" : "; ", alarm.code,
                         alarm.text);
  return stopped;
}

std::size_t Instance::unseen_alarms() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      alarms, [](const storage::Alarm& alarm) { return alarm.acknowledged_by.empty(); }));
}

std::size_t Instance::waiting() const {
  std::size_t count = 0;
  for (const history::OverviewRow& row : rows) count += row.waiting.size();
  return count;
}

bool Instance::needs_action() const {
  return is_of_site &&
         (!problem.empty() || !has_service.value_or(false) || unseen_alarms() > 0 || waiting() > 0);
}

std::vector<Instance> read_instances(const fs::path& folder, WorkerPool& workers) {
  std::vector<fs::path> files;
  std::error_code error;
  if (fs::is_regular_file(folder, error))
    throw std::invalid_argument(
        folder.string() + " is a file: name the folder of the instances, such as /etc/reident");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  std::ranges::sort(files);
  std::vector<std::optional<Instance>> read(files.size());
  workers.for_each(files.size(), [&](std::size_t i) { read[i] = read_instance(files[i]); });
  const bool is_of_tables = std::ranges::any_of(files, is_of_table);
  const std::map<std::string, std::string> pages = pages_in(folder);
  std::vector<Instance> instances;
  for (std::optional<Instance>& one : read) {
    if (!one) continue;
    if (!is_of_tables) one->is_of_site = true;
    if (const auto page = pages.find(one->name); page != pages.end()) one->page = page->second;
    instances.push_back(*std::move(one));
  }
  if (instances.empty())
    throw std::invalid_argument(folder.string() +
                                " holds no configuration (*.toml): name the folder of the "
                                "instances, such as /etc/reident");
  const auto badness = [](const Instance& one) {
    return std::tuple(one.is_of_site, !one.problem.empty(), !one.has_service.value_or(false),
                      one.unseen_alarms(), one.waiting());
  };
  std::ranges::stable_sort(instances, std::ranges::greater(), badness);
  return instances;
}

}  // namespace reident::fleet
