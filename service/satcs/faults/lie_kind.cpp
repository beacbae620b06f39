#include "service/satcs/faults/lie_kind.hpp"

#include <algorithm>
#include <array>

namespace reident::satcs {
namespace {

using S = LieFacts::Subject;
using M = LieFacts::Magnitude;

// In the order of the enumeration.
constexpr std::array<LieFacts, lie_kinds> all_facts = {{
    {LieKind::stuck, "stuck", S::any_parameter, M::of_parameter, 0},
    {LieKind::bias_step, "bias_step", S::analog_parameter, M::of_parameter, 0.02},
    {LieKind::drifting_bias, "drifting_bias", S::analog_parameter, M::of_parameter, 0.05},
    {LieKind::noise_burst, "noise_burst", S::analog_parameter, M::of_parameter, 0.02},
    {LieKind::spikes, "spikes", S::analog_parameter, M::of_parameter, 0.2},
    {LieKind::swapped, "swapped", S::two_parameters, M::none, 0},
    {LieKind::wrong_calibration, "wrong_calibration", S::analog_parameter, M::gain, 1.05},
    {LieKind::stops, "stops", S::any_parameter, M::none, 0},
    {LieKind::wrong_validity, "wrong_validity", S::all_or_one, M::share, 0.2},
    {LieKind::frames_lost, "frames_lost", S::frames, M::share, 0.1},
    {LieKind::passes_lost, "passes_lost", S::frames, M::share, 0.3},
    {LieKind::backwards_playback, "backwards_playback", S::frames, M::seconds, 600},
    {LieKind::two_stations, "two_stations", S::frames, M::seconds, 0.4},
    {LieKind::two_stamping_stations, "two_stamping_stations", S::frames, M::seconds, 0.4},
    {LieKind::time_jump, "time_jump", S::frames, M::seconds, 3600},
    {LieKind::duplicated_day, "duplicated_day", S::frames, M::seconds, 86'400},
    {LieKind::repeated_day, "repeated_day", S::frames, M::seconds, 86'400},
    {LieKind::simulated_as_real, "simulated_as_real", S::frames, M::none, 0},
}};

}  // namespace

const LieFacts& facts(LieKind kind) {
  return all_facts[static_cast<std::size_t>(kind)];
}

const LieFacts* find_facts(std::string_view name) {
  const auto found =
      std::find_if(all_facts.begin(), all_facts.end(),
                   [name](const LieFacts& candidate) { return candidate.name == name; });
  return found == all_facts.end() ? nullptr : &*found;
}

std::string lie_kind_names() {
  std::string names;
  for (const LieFacts& one : all_facts) {
    if (!names.empty()) names += ", ";
    names += one.name;
  }
  return names;
}

std::string_view name(LieKind kind) {
  return facts(kind).name;
}

std::optional<Limits> limits_of(const storage::ParameterDescriptor& parameter) {
  if (!parameter.low_limit || !parameter.high_limit) return std::nullopt;
  return Limits{*parameter.low_limit, *parameter.high_limit};
}

}  // namespace reident::satcs
