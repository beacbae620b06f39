// Operating regimes as inputs of a model: eclipse and sunlight, a heater on or off, the redundant
// unit. In its regime equipment has an offset and gains of its own, and the same dynamics. The
// model stays linear in inputs that are derived, so that whoever can run a model can run it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "service/model/derived_inputs.hpp"

namespace reident {

/// Adds to the m inputs, for each regime, m + 1 derived ones: 1 within the regime and 0 elsewhere,
/// and each input within it. A regime is an expression of parameters (expression.hpp) that is 0
/// outside of it, such as S_ECL or "I_SA < 0.1". Expressions may be none: whoever checks derived
/// inputs finds it in these.
void add_regime_inputs(const std::vector<std::string>& regimes, std::vector<std::string>& inputs,
                       std::vector<DerivedInput>& derived);

/// Places of the inputs that are 1 within a regime, among as many of which the last so many are of
/// regimes; none where there are fewer.
std::vector<std::size_t> regime_places(std::size_t inputs, int regime_inputs);

/// The name of the input that is 1 within the regime.
std::string regime_name(const std::string& regime);

}  // namespace reident
