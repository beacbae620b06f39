// The times of events on a command line.
#pragma once

#include <optional>
#include <string_view>

#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// Returns the time that the text says: one such as 2017-07-01T06:00:00Z or, with a plus sign, a
/// duration after `start`. Absent for anything else.
std::optional<storage::Time> parse_event_time(std::string_view text, storage::Time start);
/// What it takes, for messages.
inline constexpr std::string_view event_time_form =
    "a time such as 2017-07-01T06:00:00Z nor a duration after the start such as +90min";

/// Takes what follows the last `mark` off `text`, and the mark; nothing where there is no mark.
std::optional<std::string_view> cut_after_last(std::string_view& text, char mark);

}  // namespace reident::satcs
