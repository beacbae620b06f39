// What the cells of a column are, and the value of each.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "service/telemetry_file/number_text.hpp"
#include "service/telemetry_file/text_source.hpp"

namespace reident::telemetry_file {

/// Words that stand for numbers, as OFF=0, ON=1.
using StateMap = std::vector<std::pair<std::string, double>>;
/// "OFF=0,ON=1"; empty where the text is not of that form.
std::optional<StateMap> parse_states(std::string_view text);
std::string states_text(const StateMap& states);

/// Whether programs write the word for no value in a column of numbers, as "NA".
bool means_no_value(std::string_view word);

/// What is given of the cells of all columns.
struct CellOptions {
  std::optional<NumberStyle> style;
  std::vector<std::string> missing;                      // words and numbers that are no value
  std::vector<std::pair<std::string, StateMap>> states;  // by column; "": every column
};

struct Cell {
  enum class Kind {
    number,   // NaN and infinities too
    blank,    // nothing, or blanks
    missing,  // a value that the options name as missing
    bad,      // anything else
  };
  Kind kind = Kind::blank;
  double value = 0;
  bool is_flagged = false;  // a flag of limits stands behind the number
};

struct CellFormat {
  enum class Kind {
    empty,   // no cell that holds anything
    number,  // some cell holds a number
    state,   // every cell is among `states`
    text,    // no cell is a number
  };
  Kind kind = Kind::empty;
  NumberStyle style;
  unsigned spelling = 0;  // bits that its cells may have; 0: plain numbers alone
  std::string unit;       // behind every number; empty: none, or flags
  StateMap states;
  std::vector<std::string> missing;
  std::string no_value;  // the first word among numbers that is none, as NA; or empty
  /// The first different words of a column of text that no state was given for, at most 5.
  std::vector<std::string> words;
  bool may_be_states = false;  // of a column of text: so few words that they may be states
};

/// The states that the options give for a column, or for all; null where there are none.
const StateMap* given_states(const CellOptions& options, const std::string& column);
bool has_state(const StateMap& states, std::string_view word);

/// What has to be said where two styles are possible, and the row of the cell that shows it.
struct StyleQuestion {
  std::size_t row = 0;
  std::string text;
};

/// Finds the style in which the numbers of a table are written from its cells, column by column;
/// `separator` is that of the file.
std::variant<NumberStyle, StyleQuestion> find_style(
    std::span<const std::vector<std::string_view>> columns, char separator);

/// Finds the format of one column from its cells.
CellFormat find_format(std::span<const std::string_view> cells, const std::string& column,
                       NumberStyle style, const CellOptions& options);

Cell read_cell(std::string_view text, const CellFormat& format);

/// What is said of a column that is not plain: "heater: OFF=0, ON=1"; empty for a plain one.
std::string describe(const CellFormat& format);

}  // namespace reident::telemetry_file
