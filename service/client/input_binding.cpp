#include "service/client/input_binding.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "service/client/include/reident/client.h"

namespace reident {
namespace {

std::optional<std::size_t> place_of(const std::string& name,
                                    const std::vector<DeclaredSignal>& declared) {
  const auto found =
      std::find_if(declared.begin(), declared.end(),
                   [&name](const DeclaredSignal& signal) { return signal.name == name; });
  if (found == declared.end()) return std::nullopt;
  return static_cast<std::size_t>(found - declared.begin());
}

std::string missing(const std::string& name) {
  return "it needs " + name + ", which the simulator does not declare";
}

std::optional<std::string> other_unit(const Signal& signal, const DeclaredSignal& declared) {
  if (declared.unit.empty() || declared.unit == signal.unit) return std::nullopt;
  return "its " + signal.name + " is in " + (signal.unit.empty() ? "no unit" : signal.unit) +
         ", and the simulator's in " + declared.unit;
}

}  // namespace

std::variant<std::vector<std::size_t>, std::string> places_of(
    const std::vector<Signal>& signals, const std::vector<DeclaredSignal>& declared) {
  std::vector<std::size_t> places;
  for (const Signal& signal : signals) {
    const auto place = place_of(signal.name, declared);
    if (!place) return missing(signal.name);
    if (auto reason = other_unit(signal, declared[*place])) return *std::move(reason);
    places.push_back(*place);
  }
  return places;
}

std::variant<InputBinding, std::string> InputBinding::make(
    const EquipmentModel& model, const std::vector<DeclaredSignal>& declared) {
  std::vector<DerivedInput> derived;
  for (const Signal& input : model.inputs) {
    const auto place = place_of(input.name, declared);
    if (place) {
      if (auto reason = other_unit(input, declared[*place])) return *std::move(reason);
    } else if (!input.expression.empty()) {
      derived.push_back({input.name, input.expression, input.unit});
    }
  }
  InputExpressions expressions(signal_names(model.inputs), derived);
  std::vector<std::size_t> places;
  for (const std::string& parameter : expressions.parameters()) {
    const auto place = place_of(parameter, declared);
    if (!place) return missing(parameter);
    places.push_back(*place);
  }
  return InputBinding(model, std::move(expressions), std::move(places), !derived.empty());
}

InputBinding::InputBinding(const EquipmentModel& model, InputExpressions expressions,
                           std::vector<std::size_t> places, bool is_derived)
    : expressions_(std::move(expressions)),
      places_(std::move(places)),
      inputs_(model.inputs.size()),
      is_derived_(is_derived),
      parameters_(static_cast<identification::Index>(places_.size())),
      fresh_(static_cast<identification::Index>(model.inputs.size())) {
  const std::vector<std::string>& parameters = expressions_.parameters();
  const auto add_source = [&](Input& input, const std::string& parameter) {
    const auto found = std::find(parameters.begin(), parameters.end(), parameter);
    if (found != parameters.end())
      input.sources.push_back(places_[static_cast<std::size_t>(found - parameters.begin())]);
  };
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const Signal& signal = model.inputs[i];
    Input& input = inputs_[i];
    input.low = signal.low;
    input.high = signal.high;
    input.u0 = model.dynamics.u0(static_cast<identification::Index>(i));
    if (!is_derived) input.place = places_[i];
    add_source(input, signal.name);
    if (!input.sources.empty()) continue;
    const auto parsed = Expression::parse(signal.expression);
    if (const auto* expression = std::get_if<Expression>(&parsed))
      for (const std::string& variable : expression->variables()) add_source(input, variable);
  }
}

int InputBinding::bind_any(const double* declared, double* du) {
  for (std::size_t i = 0; i < places_.size(); ++i)
    parameters_(static_cast<identification::Index>(i)) = declared[places_[i]];
  expressions_.evaluate(parameters_, fresh_);
  int all = 0;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const double value = fresh_(static_cast<identification::Index>(i));
    Input& input = inputs_[i];
    if (std::isfinite(value)) {
      du[i] = value - input.u0;
      input.flags = value < input.low || value > input.high ? REIDENT_INPUT_OUTSIDE : 0;
    } else {
      // What is held was outside or not when it came.
      const int held = flagged_ ? input.flags & REIDENT_INPUT_OUTSIDE : 0;
      input.flags = REIDENT_INPUT_MISSING | held;
    }
    all |= input.flags;
  }
  flagged_ = all != 0;
  return all;
}

int InputBinding::flags(std::size_t declared) const {
  int flags = 0;
  if (!flagged_) return flags;
  for (const Input& input : inputs_)
    if (std::find(input.sources.begin(), input.sources.end(), declared) != input.sources.end())
      flags |= input.flags;
  return flags;
}

}  // namespace reident
