// The first lines of a file, cut into cells by a separator that is tried.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "service/telemetry_file/row_reader.hpp"

namespace reident::telemetry_file {

struct HeadLine {
  std::string_view text;  // without its end
  std::uint64_t number = 0;
  std::uint64_t position = 0;      // in bytes of the text
  std::vector<std::string> cells;  // none where a quoted cell is not closed in the line
};
using HeadLines = std::vector<HeadLine>;

/// What ends lines: CR where there is no LF.
char find_line_end(std::string_view text);

/// The first lines, at most 400, a byte order mark left out.
HeadLines lines_of(const RowReader::Head& head, char line_end);

bool is_blank(const HeadLine& line);
bool is_comment(const HeadLine& line, const std::string& mark);
/// What the first line that is a comment begins with; empty: there is none.
std::string find_comment(const HeadLines& lines);

void split(HeadLines& lines, char separator);
/// The number of cells that most lines have.
std::size_t usual_cells(const HeadLines& lines, const std::string& comment);
/// The separator of commas, semicolons, tabs, bars and blanks that cuts lines best: into equally
/// many cells that hold values.
char find_separator(HeadLines& lines, const std::string& comment);

/// Where the cells of columns of fixed width stand, where lines that blanks cut have fewer cells
/// than others; their blank cells are put in. Empty where the lines do not show it.
std::vector<Place> find_places(HeadLines& lines, char separator, const std::string& comment);

/// Whether a cell has the look of a number or a time, in whatever spelling.
bool looks_like_value(std::string_view cell);
/// Whether a word is that of a unit, bare or in brackets: "mV", "[A]".
bool is_unit_word(std::string_view word);

/// What is wrong with a file as a whole, or in a line of it.
Error whole_file(const std::string& name, std::string_view what);
Error at_line(const std::string& name, std::uint64_t line, std::string_view what);

}  // namespace reident::telemetry_file
