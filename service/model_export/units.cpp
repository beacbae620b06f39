#include "service/model_export/units.hpp"

#include <map>
#include <string_view>

namespace reident::model_export {
namespace {

const std::map<std::string_view, BaseUnit>& known() {
  static const std::map<std::string_view, BaseUnit> units = {
      {"A", {{{"A", 1}}}},
      {"V", {{{"kg", 1}, {"m", 2}, {"s", -3}, {"A", -1}}}},
      {"W", {{{"kg", 1}, {"m", 2}, {"s", -3}}}},
      {"J", {{{"kg", 1}, {"m", 2}, {"s", -2}}}},
      {"Wh", {{{"kg", 1}, {"m", 2}, {"s", -2}}, 3600}},
      {"Ah", {{{"A", 1}, {"s", 1}}, 3600}},
      {"Ohm", {{{"kg", 1}, {"m", 2}, {"s", -3}, {"A", -2}}}},
      {"N", {{{"kg", 1}, {"m", 1}, {"s", -2}}}},
      {"Nm", {{{"kg", 1}, {"m", 2}, {"s", -2}}}},
      {"Pa", {{{"kg", 1}, {"m", -1}, {"s", -2}}}},
      {"T", {{{"kg", 1}, {"s", -2}, {"A", -1}}}},
      {"Hz", {{{"s", -1}}}},
      {"s", {{{"s", 1}}}},
      {"m", {{{"m", 1}}}},
      {"m/s", {{{"m", 1}, {"s", -1}}}},
      {"g", {{{"kg", 1}}, 0.001}},
      {"K", {{{"K", 1}}}},
      {"degC", {{{"K", 1}}, 1, 273.15}},
      {"°C", {{{"K", 1}}, 1, 273.15}},
      {"rad", {{{"rad", 1}}}},
      {"rad/s", {{{"rad", 1}, {"s", -1}}}},
      {"deg", {{{"rad", 1}}, 0.017453292519943295}},
      {"deg/s", {{{"rad", 1}, {"s", -1}}, 0.017453292519943295}},
      {"rpm", {{{"rad", 1}, {"s", -1}}, 0.10471975511965977}},
      {"%", {{}, 0.01}},
      {"1", {}},
  };
  return units;
}

constexpr std::pair<std::string_view, double> prefixes[] = {{"n", 1e-9}, {"u", 1e-6}, {"µ", 1e-6},
                                                            {"m", 1e-3}, {"k", 1e3},  {"M", 1e6}};

}  // namespace

std::optional<BaseUnit> base_unit(const std::string& unit) {
  if (const auto found = known().find(unit); found != known().end()) return found->second;
  for (const auto& [prefix, factor] : prefixes) {
    if (!unit.starts_with(prefix)) continue;
    const auto found = known().find(std::string_view(unit).substr(prefix.size()));
    if (found == known().end() || found->second.offset != 0 || found->second.powers.empty())
      continue;
    BaseUnit result = found->second;
    result.factor *= factor;
    return result;
  }
  return std::nullopt;
}

}  // namespace reident::model_export
