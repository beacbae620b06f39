// Numbers as people write them: decimal commas, thousands, units, flags.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace reident::telemetry_file {

/// How the numbers of a file are written.
struct NumberStyle {
  char decimal = '.';
  char thousands = '\0';  // ',' '.' '\'' '_' or ' ' (any blank); '\0': none
  bool operator==(const NumberStyle&) const = default;
};

/// What a cell has besides digits, sign, decimal mark and exponent, as bits.
enum Spelling : unsigned {
  grouped = 1,       // thousands
  true_minus = 2,    // U+2212 or U+2013
  in_brackets = 4,   // (4.2) is -4.2
  hexadecimal = 8,   // 0x1F
  fortran = 16,      // 1.5D+02
  with_suffix = 32,  // a unit or a flag behind it
  decimal_comma = 64,
  in_formula = 128,     // ="4.2"
  power_apart = 256,    // 5.8 E-3, 5.8x10^-3
  in_wide_blanks = 512  // such as a blank without a break
};

/// A number and how it is written.
struct NumberText {
  double value = 0;
  unsigned spelling = 0;    // bits of Spelling
  std::string_view suffix;  // behind the number; points into the cell
};

/// Returns the number in a cell that from_chars reads alone, with blanks around and a plus sign.
/// Infinity and NaN are numbers here. Empty for anything else.
std::optional<double> plain_number(std::string_view cell);

/// Returns the number in a cell, in any spelling that goes with the style.
std::optional<NumberText> read_number(std::string_view cell, NumberStyle style);

/// Whether a cell may be a hexadecimal number without 0x, as A0 and 1F.
bool may_be_hexadecimal(std::string_view cell);

/// Whether a suffix is a flag of limits or quality, as H, LL, * or !, and no unit.
bool is_flag(std::string_view suffix);

/// What the marks in one cell show of the style.
enum class Mark { none, point, comma, point_or_thousands, comma_or_thousands, both };
struct MarkEvidence {
  Mark mark = Mark::none;
  NumberStyle style;        // where mark is `both`: which is which
  char blank_group = '\0';  // ' ' or '\'' where thousands stand apart by it
};
/// Empty where the cell is no number in any style.
std::optional<MarkEvidence> marks_in(std::string_view cell);

}  // namespace reident::telemetry_file
