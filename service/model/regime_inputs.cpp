#include "service/model/regime_inputs.hpp"

#include <algorithm>
#include <utility>

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

std::vector<std::size_t> regime_places(std::size_t inputs, int regime_inputs) {
  if (std::cmp_less(inputs, regime_inputs)) return {};
  const std::size_t plain = inputs - static_cast<std::size_t>(regime_inputs);
  std::vector<std::size_t> places;
  for (std::size_t place = plain; place < inputs; place += plain + 1) places.push_back(place);
  return places;
}

}  // namespace reident
