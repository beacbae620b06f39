// Which columns of a CSV file are replayed, and as what.
#pragma once

#include "service/satcs/replay/replay.hpp"

namespace reident::satcs {

/// Fills in plan.columns and plan.left_out. `numbers` counts the cells with a number in each column
/// of the file, whose time is found. An error where a column that the options name is not there,
/// two would be one parameter, or none is left.
std::optional<csv::Error> choose_columns(const ReplayOptions& options,
                                         const telemetry_file::TelemetryFile& reader,
                                         const std::vector<std::uint64_t>& numbers,
                                         ReplayPlan& plan);

/// Why a column is left out, and what would bring it in where its cells may be states.
std::string left_out_sentence(const telemetry_file::TelemetryFile& reader,
                              const std::string& column);

/// A column's name cut into the parameter's name and the unit at its end; the unit is empty where
/// there is none that is known.
struct NameAndUnit {
  std::string name;
  std::string unit;
  bool operator==(const NameAndUnit&) const = default;
};
NameAndUnit split_unit(std::string_view column);

}  // namespace reident::satcs
