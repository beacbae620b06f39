// A configuration with some of its keys changed, for questions of the kind "what if the window were
// longer".
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "service/config/config.hpp"

namespace reident {

/// What would be different; what is empty stays as the file has it.
struct ConfigChanges {
  std::filesystem::path database{};  // absolute
  /// "KEY=VALUE" for all equipment, or "EQUIPMENT.KEY=VALUE". A value is written as in the file;
  /// the quotes of a text may be left out.
  std::vector<std::string> equipment{};
  std::string spacecraft{};  // the name of the only one
  std::string service{}, partition{};
  std::optional<std::uint32_t> domain{};
  int strength = 0;  // in a pair of services
};

/// Returns the text of the configuration in `file` with the changes; or every mistake of the file,
/// of the changes, or of what these make of it. A relative path of the database stays relative; the
/// folder of the security becomes absolute.
std::variant<std::string, std::vector<ConfigMistake>> changed_config(
    const std::filesystem::path& file, const ConfigChanges& changes);

}  // namespace reident
