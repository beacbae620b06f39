// Finds the names of the columns above the rows, or in a comment. Private to this folder.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "service/telemetry_file/dialect.hpp"
#include "service/telemetry_file/head_lines.hpp"

namespace reident::telemetry_file {

/// Numbers of lines among the head's.
struct HeaderPlace {
  std::size_t first_row = 0;
  std::optional<std::size_t> header, units;
};

/// Finds the header of lines that were cut into cells; where it is in a comment, that is cut too.
/// An error where there is none and no names are given.
std::variant<HeaderPlace, Error> find_header(HeadLines& lines, const Layout& layout,
                                             const DialectOptions& options,
                                             const std::string& name);

}  // namespace reident::telemetry_file
