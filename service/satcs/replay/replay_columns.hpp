// Which columns of a CSV file are replayed, and as what.
#pragma once

#include <functional>

#include "service/satcs/replay/replay.hpp"

namespace reident::satcs {

/// Whether a cell of a column is a time.
using IsTime = std::function<bool(std::string_view column, std::string_view cell)>;
/// As parse_time() takes it.
bool is_time(std::string_view column, std::string_view cell);

/// Returns the column asked for, or the first that is named like a time and holds one in the row
/// that `reader` stands at, or the first that holds a calendar time there.
std::variant<std::size_t, csv::Error> find_time_column(const csv::Reader& reader,
                                                       const std::optional<std::string>& asked,
                                                       const IsTime& holds_time = is_time);

/// Fills in plan.columns and plan.left_out. `numbers` counts the cells with a number in each column
/// of the file. An error where a column that the options name is not there, two would be one
/// parameter, or none is left.
std::optional<csv::Error> choose_columns(const ReplayOptions& options, const csv::Reader& reader,
                                         const std::vector<std::uint64_t>& numbers,
                                         ReplayPlan& plan);

/// A column's name cut into the parameter's name and the unit at its end; the unit is empty where
/// there is none that is known.
struct NameAndUnit {
  std::string name;
  std::string unit;
  bool operator==(const NameAndUnit&) const = default;
};
NameAndUnit split_unit(std::string_view column);

}  // namespace reident::satcs
