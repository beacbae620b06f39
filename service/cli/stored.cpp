#include "service/cli/stored.hpp"

#include <fmt/format.h>

#include "service/cli/config_options.hpp"
#include "service/operations/commands.hpp"
#include "service/review/evidence.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::cli {

using nlohmann::ordered_json;

std::variant<std::filesystem::path, Refusal> database_path(const DatabaseOptions& options) {
  if (options.database) return *options.database;
  auto chosen = chosen_config(options.config);
  if (auto* refusal = std::get_if<Refusal>(&chosen)) return *refusal;
  if (const auto& config = std::get<std::optional<Config>>(chosen)) return config->database;
  return Refusal{
      fmt::format("no database: there is no {} here; name one with --database FILE or "
                  "--config FILE",
                  default_config_file)};
}

void add_file_argument(CLI::App& command, DatabaseOptions& options, const std::string& what) {
  command.add_option("file,--database,--db", options.database, what);
  command.add_option(
      "--config", options.config,
      fmt::format("configuration that names the database ({})", default_config_file));
}

void add_database_options(CLI::App& command, DatabaseOptions& options) {
  CLI::Option* database =
      command.add_option("--database,--db", options.database, "database of the service");
  command
      .add_option("--config", options.config,
                  fmt::format("configuration that names the database ({})", default_config_file))
      ->excludes(database);
}

int with_database(const DatabaseOptions& options,
                  const std::function<int(storage::Database&)>& work) {
  const auto path = database_path(options);
  if (const auto* refusal = std::get_if<Refusal>(&path)) return refuse(*refusal);
  try {
    storage::Database database(std::get<std::filesystem::path>(path),
                               storage::Database::Mode::read_only);
    return work(database);
  } catch (const storage::Error& error) {
    if (error.kind() != storage::Error::Kind::cannot_open &&
        error.kind() != storage::Error::Kind::newer_schema &&
        error.kind() != storage::Error::Kind::older_schema)
      throw;
    return refuse({error.what()});
  }
}

int with_writable_database(const DatabaseOptions& options,
                           const std::function<int(storage::Database&)>& work,
                           storage::Database::Mode mode) {
  const auto path = database_path(options);
  if (const auto* refusal = std::get_if<Refusal>(&path)) return refuse(*refusal);
  try {
    storage::Database database(std::get<std::filesystem::path>(path), mode);
    return work(database);
  } catch (const storage::Error& error) {
    using Kind = storage::Error::Kind;
    if (error.kind() == Kind::full || error.kind() == Kind::corrupt || error.kind() == Kind::failed)
      throw;
    return refuse({error.what()});
  }
}

std::string equipment_in(const history::HistoryReader& history) {
  std::vector<std::string> names;
  for (const auto& [spacecraft, equipment] : history.equipment())
    names.push_back(full_name({spacecraft, equipment}));
  return names.empty() ? "nothing yet" : joined(names);
}

ordered_json text_json(const std::string& text) {
  return text.empty() ? ordered_json() : ordered_json(text);
}

ordered_json alarm_json(const storage::Alarm& alarm) {
  return {{"code", alarm.code},
          {"spacecraft", text_json(alarm.about.spacecraft)},
          {"equipment", text_json(alarm.about.equipment)},
          {"since", time_text(alarm.since)},
          {"seen_by", text_json(alarm.acknowledged_by)},
          {"text", alarm.text}};
}

ordered_json hold_json(const storage::Hold& hold) {
  return {{"actor", hold.actor}, {"reason", hold.reason}, {"since", time_text(hold.since)}};
}

ordered_json decisions_json(const std::vector<storage::Decision>& decisions) {
  ordered_json list = ordered_json::array();
  for (const storage::Decision& decision : decisions) {
    list.push_back({{"kind", storage::name(decision.kind)},
                    {"time", time_text(decision.time)},
                    {"actor", decision.actor},
                    {"reason", decision.reason}});
    if (ordered_json evidence = evidence_of(decision); !evidence.empty())
      list.back()["evidence"] = std::move(evidence);
  }
  return list;
}

std::string evidence_number(const ordered_json& evidence, const char* key) {
  const auto found = evidence.find(key);
  if (found == evidence.end() || !found->is_number()) return "-";
  if (found->is_number_integer()) return found->dump();
  return fmt::format("{:.4g}", found->get<double>());
}

}  // namespace reident::cli
