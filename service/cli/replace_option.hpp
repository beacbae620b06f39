// One rule for files that commands write: one that exists is kept, unless --replace is given.
#pragma once

#include <optional>
#include <string>

#include "service/cli/command.hpp"

namespace reident::cli {

/// Adds --replace, and --force, as it was called once.
void add_replace_option(CLI::App& command, bool& replace);

/// Why the file must not be written: it exists, and is not to be replaced. Absent for one that may
/// be, and for "-", standard output.
std::optional<Refusal> exists_already(const std::string& path, bool replace);

}  // namespace reident::cli
