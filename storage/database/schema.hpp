// Tables and views of a database file; SCHEMA.md describes them. Private to storage.
#pragma once

#include <cstdint>
#include <string>

namespace reident::storage::schema {

inline constexpr std::int64_t application_id = 0x72656964;  // "reid"
inline constexpr std::int64_t version = 8;                  // kept in SQLite's user_version

/// Statements that make everything in an empty file, application_id and user_version included.
std::string creation();

/// Statements that take a file from one version to the next. Version 3 has no table `sample`: it is
/// dropped once its rows are in chunks. Files of version 4 differ from those of 5 in what they may
/// hold: no quality `disputed`.
std::string from_1_to_2();
std::string from_2_to_3();
std::string without_samples_of_2();
std::string from_3_to_4();
std::string from_5_to_6();
std::string from_6_to_7();
std::string from_7_to_8();  // from_5_to_6() makes what it adds

/// Says that the file is of this version.
std::string user_version();

}  // namespace reident::storage::schema
