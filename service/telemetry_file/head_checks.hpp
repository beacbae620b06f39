// What the first rows of a file say against taking all of it for rows of one clock and spacecraft.
// Private to this folder.
#pragma once

#include <optional>

#include "service/telemetry_file/clock.hpp"

namespace reident::telemetry_file {

/// Rows of one spacecraft and of another would be taken for one's.
std::optional<Clock::Problem> several_spacecraft(const HeadCells& head, const Clock& clock);

/// Columns that stand in pairs, each value behind its own time, have other times than the first.
std::optional<Clock::Problem> clocks_of_their_own(const HeadCells& head);

/// A row with the time of the row before and another value contradicts it. Many do where the time
/// is cut off, or is read from a part of it, or where each row is a sample of another parameter.
std::optional<Clock::Problem> repeated_times(const HeadCells& head, const Clock& clock);

}  // namespace reident::telemetry_file
