#include "service/satcs/replay/replay_columns.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "service/satcs/parameter_id.hpp"
#include "service/telemetry_file/head_lines.hpp"

namespace reident::satcs {
namespace {

using csv::Error;
using telemetry_file::TelemetryFile;

/// The columns that the options name, all of them being in the file.
std::optional<Error> check_names(const ReplayOptions& options, const TelemetryFile& reader) {
  const auto find = [&](const std::string& column) -> std::optional<Error> {
    const auto found = reader.find(column);
    if (const auto* error = std::get_if<Error>(&found)) return *error;
    return std::nullopt;
  };
  for (const auto& column : options.only) {
    if (auto error = find(column)) return error;
  }
  for (const auto& mapping : options.mappings) {
    if (auto error = find(mapping.column)) return error;
    const auto& only = options.only;
    if (!only.empty() && std::find(only.begin(), only.end(), mapping.column) == only.end()) {
      return Error{"column '" + mapping.column + "' is mapped but not among --only; add it there"};
    }
  }
  return std::nullopt;
}

const ColumnMapping* mapping_of(const ReplayOptions& options, const std::string& column) {
  const auto found =
      std::find_if(options.mappings.begin(), options.mappings.end(),
                   [&](const ColumnMapping& mapping) { return mapping.column == column; });
  return found == options.mappings.end() ? nullptr : &*found;
}

/// Every parameter once, by name and by id.
std::optional<Error> check_parameters(const TelemetryFile& reader, const ReplayPlan& plan) {
  std::map<std::uint32_t, const ReplayPlan::Column*> seen;
  for (const auto& column : plan.columns) {
    const auto [other, added] = seen.emplace(column.parameter.id, &column);
    if (added) continue;
    return Error{"columns '" + reader.columns()[other->second->position] + "' and '" +
                 reader.columns()[column.position] + "' would both be parameter '" +
                 column.parameter.name + "'; give one of them another name with --map"};
  }
  return std::nullopt;
}

/// The unit in brackets at the end of a name, as in "I load (A)"; empty where there is none.
std::string unit_in_brackets(std::string_view column) {
  const auto open = column.find_last_of("([");
  if (open == std::string_view::npos || open == 0 ||
      column.find_first_of(")]", open) + 1 != column.size())
    return {};
  const std::string_view unit = column.substr(open + 1, column.size() - open - 2);
  return telemetry_file::is_unit_word(unit) ? std::string(unit) : std::string();
}

storage::ParameterDescriptor parameter_of(const ReplayOptions& options, const TelemetryFile& reader,
                                          std::size_t position, const std::string& file) {
  const std::string& column = reader.columns()[position];
  NameAndUnit as{column, {}};
  if (const ColumnMapping* mapping = mapping_of(options, column); mapping != nullptr)
    as = {mapping->parameter, mapping->unit};
  else if (!options.keep_names)
    as = split_unit(column);
  if (as.unit.empty()) as.unit = reader.unit(position);
  if (as.unit.empty()) as.unit = unit_in_brackets(column);
  storage::ParameterDescriptor parameter;
  parameter.id = parameter_id(as.name);
  parameter.name = as.name;
  parameter.unit = as.unit;
  parameter.description = "column " + column + " of " + file;
  const auto& format = reader.format(position);
  if (format.kind == telemetry_file::CellFormat::Kind::state) {
    parameter.kind = storage::ParameterKind::digital;
    parameter.description =
        "states " + telemetry_file::states_text(format.states) + "; " + parameter.description;
  }
  return parameter;
}

}  // namespace

std::optional<Error> choose_columns(const ReplayOptions& options, const TelemetryFile& reader,
                                    const std::vector<std::uint64_t>& numbers, ReplayPlan& plan) {
  if (auto error = check_names(options, reader)) return error;
  const auto& only = options.only;
  for (std::size_t c = 0; c < numbers.size(); ++c) {
    const std::string& column = reader.columns()[c];
    if (reader.is_time(c) || column.empty()) continue;
    if (!only.empty() && std::find(only.begin(), only.end(), column) == only.end()) continue;
    if (numbers[c] == 0 && mapping_of(options, column) == nullptr) {
      plan.left_out.push_back(column);
      continue;
    }
    plan.columns.push_back({c, parameter_of(options, reader, c, plan.file.filename().string())});
  }
  if (plan.columns.empty()) {
    std::string text = plan.file.string() + ": no column holds numbers besides the time '" +
                       plan.time_column + "'; there is nothing to send or to import";
    for (const auto& column : plan.left_out) text += "; " + left_out_sentence(reader, column);
    return Error{std::move(text)};
  }
  return check_parameters(reader, plan);
}

std::string left_out_sentence(const TelemetryFile& reader, const std::string& column) {
  const auto at = std::get<std::size_t>(reader.find(column));
  std::string text =
      "column '" + column + "' is left out, its cells are no numbers: " + reader.first_word(at);
  if (reader.format(at).may_be_states)
    text += "; --map-states " + column + ":STATE=NUMBER,... makes numbers of states";
  return text;
}

NameAndUnit split_unit(std::string_view column) {
  struct Suffix {
    std::string_view text;
    std::string_view unit;
  };
  constexpr std::array<Suffix, 29> suffixes = {
      {{"uv", "uV"},   {"mv", "mV"},     {"v", "V"},     {"kv", "kV"},   {"ua", "uA"},
       {"ma", "mA"},   {"a", "A"},       {"mw", "mW"},   {"w", "W"},     {"kw", "kW"},
       {"mah", "mAh"}, {"ah", "Ah"},     {"wh", "Wh"},   {"s", "s"},     {"ms", "ms"},
       {"c", "degC"},  {"degc", "degC"}, {"k", "K"},     {"deg", "deg"}, {"rad", "rad"},
       {"hz", "Hz"},   {"khz", "kHz"},   {"mhz", "MHz"}, {"pa", "Pa"},   {"kpa", "kPa"},
       {"bar", "bar"}, {"ohm", "Ohm"},   {"pct", "%"},   {"rpm", "rpm"}}};
  const auto underscore = column.rfind('_');
  if (underscore != std::string_view::npos && underscore > 0) {
    const auto tail = column.substr(underscore + 1);
    const auto* found = std::find_if(suffixes.begin(), suffixes.end(),
                                     [&](const Suffix& suffix) { return suffix.text == tail; });
    if (found != suffixes.end()) {
      return {std::string(column.substr(0, underscore)), std::string(found->unit)};
    }
  }
  return {std::string(column), {}};
}

}  // namespace reident::satcs
