#include "service/cli/replace_option.hpp"

#include <filesystem>

#include <fmt/format.h>

namespace reident::cli {

void add_replace_option(CLI::App& command, bool& replace) {
  command.add_flag("--replace,--force", replace, "replace a file that exists");
}

std::optional<Refusal> exists_already(const std::string& path, bool replace) {
  std::error_code error;
  if (replace || path == "-" || !std::filesystem::exists(path, error) ||
      std::filesystem::is_character_file(path, error) || std::filesystem::is_fifo(path, error))
    return std::nullopt;
  return Refusal{fmt::format("{} exists; name another file, or replace it with --replace", path)};
}

}  // namespace reident::cli
