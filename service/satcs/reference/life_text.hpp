// Events of the reference spacecraft's life as text, for command lines.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "service/satcs/reference/reference_life.hpp"

namespace reident::satcs {

/// Why a text is no event.
struct LifeError {
  std::string message;  // what is wrong and what would mend it
};

/// "KIND@TIME[/TIME][*MAGNITUDE][#UNIT]", such as "capacity_fade@+1d/+20d*0.2#1". The times are
/// times or, with a plus sign, durations after `start`; without a second one a change is a step and
/// a mode lasts for good. The result is without life_mistake().
std::variant<reference::LifeEvent, LifeError> parse_life_event(std::string_view text,
                                                               storage::Time start);

/// "array_degradation, capacity_fade, ...".
std::string life_kind_names();

}  // namespace reident::satcs
