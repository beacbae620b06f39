// What the commands that read a database share: which file, and what is in it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "service/cli/command.hpp"
#include "service/history/readers.hpp"
#include "storage/registry/registry.hpp"

namespace reident::cli {

/// --database and --config; without either, reident.toml in the current folder says which file.
struct DatabaseOptions {
  std::optional<std::string> database;
  std::optional<std::string> config;
};

void add_database_options(CLI::App& command, DatabaseOptions& options);

/// The database as the first argument, and the same two options.
void add_file_argument(CLI::App& command, DatabaseOptions& options, const std::string& what);

/// The database that the options name. Refused where they name none.
std::variant<std::filesystem::path, Refusal> database_path(const DatabaseOptions& options);

/// Calls `work` with a database opened for reading. A database that cannot be used is refused.
int with_database(const DatabaseOptions& options,
                  const std::function<int(storage::Database&)>& work);

/// Calls `work` with a database opened for writing: by default made where there is none. Refused
/// while another program writes.
int with_writable_database(const DatabaseOptions& options,
                           const std::function<int(storage::Database&)>& work,
                           storage::Database::Mode mode = storage::Database::Mode::read_write);

/// The equipment of the database for messages, such as "CBERS-4/BDR, CBERS-4/MEA".
std::string equipment_in(const history::HistoryReader& history);

/// Returns a text, or null where it is empty: what is absent is null in JSON.
nlohmann::ordered_json text_json(const std::string& text);

/// Returns an alarm as `reident overview` and `reident fleet status` have it.
nlohmann::ordered_json alarm_json(const storage::Alarm& alarm);

nlohmann::ordered_json hold_json(const storage::Hold& hold);
nlohmann::ordered_json decisions_json(const std::vector<storage::Decision>& decisions);

/// A number of the evidence for a table, "-" where it is absent.
std::string evidence_number(const nlohmann::ordered_json& evidence, const char* key);

}  // namespace reident::cli
