// Units of telemetry in the base units of the SI, as modelDescription.xml gives them.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace reident::model_export {

/// value in base units = factor * value + offset
struct BaseUnit {
  struct Power {
    std::string unit;  // kg, m, s, A, K or rad
    int exponent = 0;
  };
  std::vector<Power> powers;
  double factor = 1;
  double offset = 0;
};

/// Returns what a unit such as "A", "mV", "degC" or "Ah" is. Empty where it is not known: an FMU
/// then has its name alone. A prefix from n to M is taken off a unit that has one and no offset.
std::optional<BaseUnit> base_unit(const std::string& unit);

}  // namespace reident::model_export
