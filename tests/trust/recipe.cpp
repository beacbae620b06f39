#include "tests/trust/recipe.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "service/support/time_text.hpp"

namespace reident::trust {
namespace {

std::string text_of(const satcs::reference::LifeEvent& event) {
  return fmt::format("{}@{}/{}*{}#{}", name(event.kind), time_text(event.begin),
                     time_text(event.end), event.magnitude, event.unit);
}

std::string text_of(const satcs::Fault& fault) {
  std::string text = fmt::format("{}@{}/{}", name(fault.kind), time_text(fault.when.begin),
                                 time_text(fault.when.end));
  if (!fault.parameter.empty()) text += ':' + fault.parameter;
  if (!fault.other.empty()) text += ',' + fault.other;
  if (fault.magnitude) text += fmt::format("*{}", *fault.magnitude);
  return text + fmt::format("#{}", fault.seed);
}

std::vector<std::string> arguments_of(const LifeGroup& group, Duration duration) {
  std::vector<std::string> arguments{"--start",    time_text(group.start),
                                     "--duration", duration_text(duration),
                                     "--seed",     fmt::to_string(group.seed)};
  if (group.family != satcs::Family::power) {
    arguments.emplace_back("--family");
    arguments.emplace_back(name(group.family));
  }
  for (const auto& event : group.events) {
    arguments.emplace_back("--life");
    arguments.push_back(text_of(event));
  }
  return arguments;
}

}  // namespace

Recipe recipe_of(const LifeGroup& group, const Scenario& scenario) {
  Recipe recipe{arguments_of(group, std::min(group.duration, simulator_sends)),
                arguments_of(group, group.duration)};
  recipe.simulator.emplace_back("--simulated");
  for (const satcs::Fault& fault : scenario.faults) {
    recipe.spacecraft.emplace_back("--fault");
    recipe.spacecraft.push_back(text_of(fault));
  }
  return recipe;
}

}  // namespace reident::trust
