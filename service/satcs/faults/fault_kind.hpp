// What is known of each kind of fault. Private to faults.
#pragma once

#include "service/satcs/faults/fault_injector.hpp"

namespace reident::satcs {

/// One row of the table of kinds; REFERENCE.md, "Telemetry faults", has it in words.
struct FaultFacts {
  enum class Subject { frames, any_parameter, analog_parameter, all_or_one, two_parameters };
  enum class Magnitude { none, of_parameter, gain, share, seconds };

  FaultKind kind = FaultKind::stuck;
  std::string_view name;
  Subject subject = Subject::frames;  // what it names
  Magnitude magnitude = Magnitude::none;
  double usual = 0;  // magnitude where none is given; of_parameter: as a share of the span
};
const FaultFacts& facts(FaultKind kind);
/// Nullptr where there is no such kind.
const FaultFacts* find_facts(std::string_view name);

/// What the parameter's sensor can say, in its unit.
struct Limits {
  double low = 0;
  double high = 0;
  double span() const { return high - low; }
};
/// Absent where the descriptor lacks one of the limits.
std::optional<Limits> limits_of(const storage::ParameterDescriptor& parameter);

}  // namespace reident::satcs
