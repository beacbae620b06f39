// What is common to the reading of files of values.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace reident::csv {

/// Why a file or a row cannot be read.
struct Error {
  std::string message;  // one line, for a console: file, line, what is wrong and what would mend it
};

/// Returns the number in a cell, as in "1.5", " +1.5 " and "1e3". Empty where the cell is blank or
/// no finite number ("", "nan", "inf", "n/a"): a missing value, never a zero.
std::optional<double> to_number(std::string_view cell);

}  // namespace reident::csv
