#include "service/model/regime_inputs.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace reident {

std::string regime_name(const std::string& regime) {
  return "in " + regime;
}

void add_regime_inputs(const std::vector<std::string>& regimes, std::vector<std::string>& inputs,
                       std::vector<DerivedInput>& derived) {
  std::vector<DerivedInput> plain;
  for (const std::string& input : inputs) {
    const auto known = std::ranges::find(derived, input, &DerivedInput::name);
    plain.push_back(known == derived.end() ? DerivedInput{input, input, ""} : *known);
  }
  const auto add = [&](DerivedInput one) {
    inputs.push_back(one.name);
    derived.push_back(std::move(one));
  };
  for (const std::string& regime : regimes) {
    add({regime_name(regime), fmt::format("({}) != 0", regime), ""});
    for (const DerivedInput& input : plain)
      add({fmt::format("{} {}", input.name, regime_name(regime)),
           fmt::format("({}) * (({}) != 0)", input.expression, regime), input.unit});
  }
}

}  // namespace reident
