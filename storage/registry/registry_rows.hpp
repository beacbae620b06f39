// The registry's rows in SQL. Private to storage.
#pragma once

#include <string>
#include <string_view>

#include "storage/database/sqlite.hpp"
#include "storage/registry/registry.hpp"

namespace reident::storage {

/// The statement that reads rows for the function below it; `rest` follows its FROM.
std::string version_sql(std::string_view rest);
Version read_version(const sqlite::Query& row);

std::string decision_sql(std::string_view rest);
/// Throws Error (corrupt) for a kind that does not exist.
Decision read_decision(const sqlite::Query& row);

std::string attempt_sql(std::string_view rest);
Attempt read_attempt(const sqlite::Query& row);

}  // namespace reident::storage
