#include "service/satcs/faults/fault_kind.hpp"

#include <algorithm>
#include <array>

namespace reident::satcs {
namespace {

using S = FaultFacts::Subject;
using M = FaultFacts::Magnitude;

// In the order of the enumeration.
constexpr std::array<FaultFacts, fault_kinds> all_facts = {{
    {FaultKind::stuck, "stuck", S::any_parameter, M::of_parameter, 0},
    {FaultKind::bias_step, "bias_step", S::analog_parameter, M::of_parameter, 0.02},
    {FaultKind::drifting_bias, "drifting_bias", S::analog_parameter, M::of_parameter, 0.05},
    {FaultKind::noise_burst, "noise_burst", S::analog_parameter, M::of_parameter, 0.02},
    {FaultKind::spikes, "spikes", S::analog_parameter, M::of_parameter, 0.2},
    {FaultKind::swapped, "swapped", S::two_parameters, M::none, 0},
    {FaultKind::wrong_calibration, "wrong_calibration", S::analog_parameter, M::gain, 1.05},
    {FaultKind::stops, "stops", S::any_parameter, M::none, 0},
    {FaultKind::wrong_validity, "wrong_validity", S::all_or_one, M::share, 0.2},
    {FaultKind::frames_lost, "frames_lost", S::frames, M::share, 0.1},
    {FaultKind::passes_lost, "passes_lost", S::frames, M::share, 0.3},
    {FaultKind::backwards_playback, "backwards_playback", S::frames, M::seconds, 600},
    {FaultKind::two_stations, "two_stations", S::frames, M::seconds, 0.4},
    {FaultKind::two_stamping_stations, "two_stamping_stations", S::frames, M::seconds, 0.4},
    {FaultKind::time_jump, "time_jump", S::frames, M::seconds, 3600},
    {FaultKind::duplicated_day, "duplicated_day", S::frames, M::seconds, 86'400},
    {FaultKind::repeated_day, "repeated_day", S::frames, M::seconds, 86'400},
    {FaultKind::simulated_as_real, "simulated_as_real", S::frames, M::none, 0},
}};

}  // namespace

const FaultFacts& facts(FaultKind kind) {
  return all_facts[static_cast<std::size_t>(kind)];
}

const FaultFacts* find_facts(std::string_view name) {
  const auto found =
      std::find_if(all_facts.begin(), all_facts.end(),
                   [name](const FaultFacts& candidate) { return candidate.name == name; });
  return found == all_facts.end() ? nullptr : &*found;
}

std::string fault_kind_names() {
  std::string names;
  for (const FaultFacts& one : all_facts) {
    if (!names.empty()) names += ", ";
    names += one.name;
  }
  return names;
}

std::string_view name(FaultKind kind) {
  return facts(kind).name;
}

std::optional<Limits> limits_of(const storage::ParameterDescriptor& parameter) {
  if (!parameter.low_limit || !parameter.high_limit) return std::nullopt;
  return Limits{*parameter.low_limit, *parameter.high_limit};
}

}  // namespace reident::satcs
