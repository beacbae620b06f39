// Completion of verbs and options in shells, made from the table of verbs.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace reident::cli {

/// The script for bash, zsh or fish; absent for any other shell.
std::optional<std::string> completion_script(std::string_view shell);

}  // namespace reident::cli
