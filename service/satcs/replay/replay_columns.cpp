#include "service/satcs/replay/replay_columns.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "service/satcs/parameter_id.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

using csv::Error;

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return result;
}

bool named_like_a_time(std::string_view column) {
  const std::string name = lower(column);
  if (name == "t" || name == "t_s") return true;
  constexpr std::array<std::string_view, 5> hints = {"time", "unix", "date", "utc", "epoch"};
  return std::any_of(hints.begin(), hints.end(),
                     [&](std::string_view hint) { return name.find(hint) != std::string::npos; });
}

/// The columns that the options name, all of them being in the file.
std::optional<Error> check_names(const ReplayOptions& options, const csv::Reader& reader) {
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
std::optional<Error> check_parameters(const csv::Reader& reader, const ReplayPlan& plan) {
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

}  // namespace

bool is_time(std::string_view, std::string_view cell) {
  return parse_time(cell).has_value();
}

std::variant<std::size_t, Error> find_time_column(const csv::Reader& reader,
                                                  const std::optional<std::string>& asked,
                                                  const IsTime& holds_time) {
  if (asked) return reader.find(*asked);
  const auto& columns = reader.columns();
  const auto cells = reader.cells();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (named_like_a_time(columns[c]) && holds_time(columns[c], cells[c])) return c;
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!csv::to_number(cells[c]) && holds_time(columns[c], cells[c])) return c;
  }
  return reader.error_here("no column looks like a time; name it with --time (the columns are: " +
                           joined(columns) + ")");
}

std::optional<Error> choose_columns(const ReplayOptions& options, const csv::Reader& reader,
                                    const std::vector<std::uint64_t>& numbers, ReplayPlan& plan) {
  if (auto error = check_names(options, reader)) return error;
  const auto& only = options.only;
  for (std::size_t c = 0; c < numbers.size(); ++c) {
    const std::string& column = reader.columns()[c];
    if (c == plan.time_position || column.empty()) continue;
    if (!only.empty() && std::find(only.begin(), only.end(), column) == only.end()) continue;
    const ColumnMapping* mapping = mapping_of(options, column);
    if (numbers[c] == 0 && mapping == nullptr) {
      plan.left_out.push_back(column);
      continue;
    }
    NameAndUnit as{column, {}};
    if (mapping != nullptr) {
      as = {mapping->parameter, mapping->unit};
    } else if (!options.keep_names) {
      as = split_unit(column);
    }
    storage::ParameterDescriptor parameter;
    parameter.id = parameter_id(as.name);
    parameter.name = as.name;
    parameter.unit = as.unit;
    parameter.description = "column " + column + " of " + plan.file.filename().string();
    plan.columns.push_back({c, std::move(parameter)});
  }
  if (plan.columns.empty()) {
    return Error{plan.file.string() + ": no column holds numbers besides the time '" +
                 plan.time_column + "'; there is nothing to replay"};
  }
  return check_parameters(reader, plan);
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
