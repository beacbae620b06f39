// The file in which a task of a sweep leaves its result: one JSON value, and the SHA-256 of its
// text on the last line.
//
// It is written under a name of its own and takes its place in one step. So a task that is killed
// leaves nothing that counts, and of two that do the same work the last one replaces the same
// bytes.
#pragma once

#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

namespace reident::sweep {

/// Throws std::runtime_error with file and remedy.
void write_task_file(const std::filesystem::path& file, const nlohmann::ordered_json& result);

/// Absent where there is no such file, or its text is not that of the checksum.
std::optional<nlohmann::ordered_json> read_task_file(const std::filesystem::path& file);

}  // namespace reident::sweep
