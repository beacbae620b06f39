// Tables and views of a database file; SCHEMA.md describes them. Private to storage.
#pragma once

#include <cstdint>
#include <string>

namespace reident::storage::schema {

inline constexpr std::int64_t application_id = 0x72656964;  // "reid"
inline constexpr std::int64_t version = 2;                  // kept in SQLite's user_version

/// Statements that make everything in an empty file, application_id and user_version included.
std::string creation();

/// Statements that turn a file of version 1 into one of this version, user_version included.
std::string migration_from_1();

}  // namespace reident::storage::schema
