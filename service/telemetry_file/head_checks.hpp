// What the first rows of a file say against taking all of it for rows of one clock and spacecraft.
// Private to this folder.
#pragma once

#include <optional>

#include "service/telemetry_file/clock.hpp"

namespace reident::telemetry_file {

/// A column that names the spacecraft of each row.
struct SpacecraftColumn {
  std::size_t position = 0;
  std::string name, spacecraft;  // its own name; the first spacecraft, or empty
  std::uint64_t line = 0;        // of the first cell that names it
};
std::vector<SpacecraftColumn> spacecraft_columns(const HeadCells& head, const Clock& clock);

/// Rows of one spacecraft and of another would be taken for one's: what is wrong where a row names
/// another one than the rows before.
std::optional<std::string> names_another(const SpacecraftColumn& column,
                                         std::span<const std::string_view> cells);
std::optional<Clock::Problem> several_spacecraft(const SpacecraftColumn& column,
                                                 const HeadCells& head);

/// Columns of texts that are other times than those of the clock.
std::vector<std::string> other_times(const std::vector<std::string>& names,
                                     std::span<const std::vector<std::string_view>> columns,
                                     std::span<const CellFormat> formats, const Clock& clock);

/// Whether a cell, behind which a text ends, is cut by what the others of its column show: all
/// others have as many decimals and more than it, or as many digits and are ten times as large, or
/// are texts of one length. Few others show nothing.
bool is_shorter_than_all(std::string_view cell, std::span<const std::string_view> column,
                         char decimal);

/// Whether names that were read in a one-byte encoding may be of another: most letters are none of
/// the alphabet.
bool are_doubtful_names(const std::vector<std::string>& names, std::string_view encoding);

/// Columns that stand in pairs, each value behind its own time, have other times than the first.
std::optional<Clock::Problem> clocks_of_their_own(const HeadCells& head);

/// Parts of a second as 22:00:00.5 and .15 may be milliseconds without their zeros: what is wrong
/// where the clock goes back unless they are.
std::optional<Clock::Problem> unpadded_parts(const HeadCells& head, const Clock& clock);

/// A row with the time of the row before and another value contradicts it. Many do where the time
/// is cut off, or is read from a part of it, or where each row is a sample of another parameter.
std::optional<Clock::Problem> repeated_times(const HeadCells& head, const Clock& clock);

}  // namespace reident::telemetry_file
