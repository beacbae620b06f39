// The conditions R1 to R5 as a table for people: what each asks for, what was found, whether it
// holds.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "service/judgement/league.hpp"

namespace reident {

struct Condition {
  std::string_view rule;     // "R1"
  std::string asked, found;  // as phrases
  std::optional<bool>
      holds;  // absent where it was not looked at, since one before it does not hold
};

/// Returns the conditions in the order in which they are looked at. `obstacle` is the code of what
/// is against the version, empty where nothing is; `finding` has the figures. Requires a finding
/// against a champion.
std::vector<Condition> conditions_of(const Finding& finding, std::string_view obstacle,
                                     const EquipmentConfig& limits);

}  // namespace reident
