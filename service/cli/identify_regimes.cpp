#include "service/cli/identify_regimes.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

namespace reident::cli {
namespace {

using telemetry_file::TelemetryFile;

constexpr std::size_t most_values = 8;

/// How often each column has a value. What cannot be read is for whoever reads the rows.
using Counts = std::map<std::string, std::map<double, std::size_t>>;

Counts count_values(TelemetryFile& file, const std::map<std::string, std::size_t>& columns) {
  Counts counts;
  for (auto step = file.next(); step != TelemetryFile::Step::end; step = file.next()) {
    if (step == TelemetryFile::Step::error) {
      if (file.damage() == telemetry_file::Damage::none) break;
      continue;
    }
    for (const auto& [name, place] : columns) {
      const auto cell = file.cell(place);
      auto& values = counts[name];
      if (cell.kind == telemetry_file::Cell::Kind::number && std::isfinite(cell.value) &&
          values.size() <= most_values)
        ++values[cell.value];
    }
  }
  return counts;
}

}  // namespace

std::variant<std::vector<std::string>, Refusal> regimes_of(
    TelemetryFile& file, const std::vector<std::string>& regimes) {
  std::map<std::string, std::size_t> columns;
  for (const std::string& regime : regimes) {
    const auto found = file.find(regime);
    if (const auto* place = std::get_if<std::size_t>(&found)) columns.emplace(regime, *place);
  }
  if (columns.empty()) return regimes;
  const Counts counts = count_values(file, columns);
  std::vector<std::string> conditions;
  for (const std::string& regime : regimes) {
    const auto found = counts.find(regime);
    if (found == counts.end()) {
      conditions.push_back(regime);
      continue;
    }
    const auto& values = found->second;
    if (values.size() > most_values)
      return Refusal{fmt::format(
          "--regime {0}: the column has more than {1} values; write a condition, such as "
          "\"{0} > {2:g}\"",
          regime, most_values, std::next(values.begin(), most_values / 2)->first)};
    if (values.size() <= 1 || (values.size() == 2 && values.contains(0))) {
      conditions.push_back(regime);
      continue;
    }
    const auto usual =
        std::ranges::max_element(values, {}, [](const auto& one) { return one.second; });
    for (const auto& [value, count] : values)
      if (value != usual->first) conditions.push_back(fmt::format("{} == {}", regime, value));
  }
  return conditions;
}

}  // namespace reident::cli
