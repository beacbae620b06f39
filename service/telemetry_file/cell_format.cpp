#include "service/telemetry_file/cell_format.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "service/support/text.hpp"

namespace reident::telemetry_file {
namespace {

constexpr double agreement = 0.9;  // of a column's cells, for a spelling that is not plain
constexpr std::size_t most_states = 32;
constexpr std::size_t words_shown = 5;
constexpr std::size_t cells_of_decimals = 50;  // that have three digits behind a comma, and all do

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

/// Pairs of words that everybody reads as 0 and 1.
constexpr std::array<std::array<std::string_view, 2>, 10> known_pairs = {{{"OFF", "ON"},
                                                                          {"FALSE", "TRUE"},
                                                                          {"NO", "YES"},
                                                                          {"DISABLED", "ENABLED"},
                                                                          {"DISABLE", "ENABLE"},
                                                                          {"DIS", "ENA"},
                                                                          {"INACTIVE", "ACTIVE"},
                                                                          {"F", "T"},
                                                                          {"N", "Y"},
                                                                          {"LOW", "HIGH"}}};

/// The other word in the letter case of the first one: "Off" for "On".
std::string in_case_of(std::string_view word, std::string_view other) {
  std::string result(other);
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  for (std::size_t i = 0; i < result.size(); ++i)
    if (is_lower(word[i == 0 ? 0 : word.size() - 1]))
      result[i] = static_cast<char>(result[i] | 0x20);
  return result;
}

/// Adds both words of a known pair; false where the word is of none.
bool add_pair(const std::string& word, StateMap& states) {
  const std::string capital = upper(word);
  for (const auto& pair : known_pairs)
    for (std::size_t i = 0; i < 2; ++i) {
      if (pair[i] != capital) continue;
      const std::pair<std::string, double> both[] = {
          {word, static_cast<double>(i)},
          {in_case_of(word, pair[1 - i]), static_cast<double>(1 - i)}};
      for (const auto& one : both)
        if (std::none_of(states.begin(), states.end(),
                         [&](const auto& state) { return state.first == one.first; }))
          states.push_back(one);
      return true;
    }
  return false;
}

bool is_missing(std::string_view cell, const std::vector<std::string>& missing) {
  return std::any_of(missing.begin(), missing.end(), [&](const std::string& word) {
    if (cell == word) return true;
    const auto value = plain_number(cell), named = plain_number(word);
    return value && named && *value == *named;
  });
}

/// What instruments write for a value that they could not measure, by SCPI: overflow and none.
bool is_no_measurement(double value) {
  constexpr double overflow = 9.9e37, none = 9.91e37;
  return std::abs(value) >= overflow && (std::abs(value) == overflow || std::abs(value) == none);
}

/// "1 (ON)" and "ON (1)": the word and its number.
std::optional<std::pair<std::string, double>> coded_state(std::string_view cell) {
  if (cell.empty() || (cell.back() != ')' && cell.back() != ']')) return std::nullopt;
  const auto open = cell.find_first_of("([");
  if (open == std::string_view::npos) return std::nullopt;
  const std::string_view outside = trimmed(cell.substr(0, open));
  const std::string_view within = trimmed(cell.substr(open + 1, cell.size() - open - 2));
  if (outside.empty() || within.empty()) return std::nullopt;
  const auto first = plain_number(outside), second = plain_number(within);
  if (first.has_value() == second.has_value()) return std::nullopt;
  return first ? std::pair(std::string(within), *first) : std::pair(std::string(outside), *second);
}

/// The states of cells that are words, where they are given or known.
StateMap states_of(const std::set<std::string>& words, const StateMap* given) {
  StateMap states;
  for (const std::string& word : words) {
    if (const auto coded = coded_state(word)) {
      states.emplace_back(word, coded->second);
      continue;
    }
    if (given) {
      if (!has_state(*given, word)) return {};
      states = *given;
      continue;
    }
    if (!add_pair(word, states)) return {};
  }
  std::sort(states.begin(), states.end(),
            [](const auto& a, const auto& b) { return a.second < b.second; });
  return states;
}

struct Counts {
  std::size_t point = 0, comma = 0, point_or = 0, comma_or = 0, bare = 0, short_bare = 0;
  struct First {
    std::string_view cell;
    std::size_t row = 0;
  };
  First first_point, first_comma, first_ambiguous;
};

/// 28.02.2024, as in Germany, where the decimal mark is a comma.
bool is_date_with_points(std::string_view cell) {
  cell = trimmed(cell);
  const auto is_digit = [&](std::size_t at) { return cell[at] >= '0' && cell[at] <= '9'; };
  return cell.size() >= 10 && cell[2] == '.' && cell[5] == '.' && is_digit(0) && is_digit(6) &&
         is_digit(8);
}

StyleQuestion marks_differ(const Counts::First& one, const Counts::First& other) {
  return {std::min(one.row, other.row),
          fmt::format("'{}' and '{}' have different decimal marks; say which is right: --decimal "
                      "point --thousands comma, or --decimal comma --thousands point",
                      one.cell, other.cell)};
}

}  // namespace

bool means_no_value(std::string_view word) {
  constexpr std::array<std::string_view, 10> words = {"NA",   "N/A",  "<NA>", "#N/A", "NULL",
                                                      "null", "None", "\\N",  "NaT",  "missing"};
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool has_state(const StateMap& states, std::string_view word) {
  return std::any_of(states.begin(), states.end(),
                     [&](const auto& state) { return state.first == word; });
}

const StateMap* given_states(const CellOptions& options, const std::string& column) {
  for (const auto& [name, states] : options.states)
    if (name == column) return &states;
  for (const auto& [name, states] : options.states)
    if (name.empty()) return &states;
  return nullptr;
}

std::optional<StateMap> parse_states(std::string_view text) {
  StateMap states;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    const std::string_view part = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::size_t equals = part.rfind('=');
    if (equals == std::string_view::npos || equals == 0) return std::nullopt;
    const auto value = plain_number(part.substr(equals + 1));
    if (!value || !std::isfinite(*value)) return std::nullopt;
    states.emplace_back(trimmed(part.substr(0, equals)), *value);
  }
  if (states.empty()) return std::nullopt;
  return states;
}

std::string states_text(const StateMap& states) {
  std::string text;
  for (const auto& [word, value] : states)
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", word, value);
  return text;
}

std::variant<NumberStyle, StyleQuestion> find_style(
    std::span<const std::vector<std::string_view>> columns, char separator) {
  Counts all;
  char apart = '\0';
  std::optional<NumberStyle> certain;
  bool has_date_with_points = false, has_mixed_points = false;
  bool has_mixed_column =
      false;  // of such cells and others without a mark, of three digits at most
  std::size_t columns_of_commas = 0, bare = 0;
  for (const auto& cells : columns) {
    Counts here;
    std::string_view first_bare;
    bool bare_differ = false;  // a single value, as -999, may stand for none
    for (std::size_t row = 0; row < cells.size(); ++row) {
      const std::string_view cell = cells[row];
      const auto evidence = marks_in(cell);
      if (!evidence) {
        has_date_with_points = has_date_with_points || is_date_with_points(cell);
        continue;
      }
      if (evidence->blank_group != '\0') apart = evidence->blank_group;
      switch (evidence->mark) {
        case Mark::none:
          if (here.bare++ == 0) first_bare = cell;
          bare_differ = bare_differ || cell != first_bare;
          if (trimmed(cell).size() <= 4) ++here.short_bare;  // with a sign
          break;
        case Mark::point:
          if (all.point++ == 0) all.first_point = {cell, row};
          break;
        case Mark::comma:
          if (all.comma++ == 0) all.first_comma = {cell, row};
          break;
        case Mark::point_or_thousands:
          ++here.point_or;
          if (all.point_or++ == 0 && all.point == 0) all.first_point = {cell, row};
          break;
        case Mark::comma_or_thousands:
          if (all.comma_or++ == 0) all.first_ambiguous = {cell, row};
          ++here.comma_or;
          break;
        case Mark::both:
          if (certain && *certain != evidence->style)
            return StyleQuestion{
                row, fmt::format("'{}' and others write numbers in two ways; say with --decimal "
                                 "point or --decimal comma which is right",
                                 cell)};
          certain = evidence->style;
          break;
      }
    }
    columns_of_commas += here.comma_or > 0 ? 1 : 0;
    bare += here.bare;
    if (here.point_or > 0 && bare_differ && here.bare == here.short_bare) has_mixed_points = true;
    if (here.comma_or > 0 && here.bare > 0 && here.bare == here.short_bare) has_mixed_column = true;
  }
  if (certain && (certain->decimal == '.' ? all.comma == 0 : all.point == 0)) return *certain;
  if (all.point > 0 && all.comma > 0) return marks_differ(all.first_point, all.first_comma);
  if (all.comma > 0) return NumberStyle{',', all.point_or > 0 ? '.' : apart};
  // 6.000 next to 28.02.2024, or to 998: a program that writes so may write thousands so too.
  const bool may_be_thousands = has_mixed_points || (has_date_with_points && separator == ';');
  if (all.comma_or == 0 && all.point == 0 && all.point_or > 2 && may_be_thousands)
    return StyleQuestion{
        all.first_point.row,
        fmt::format("'{}' may be a decimal point or thousands; say --decimal point "
                    "or --thousands point",
                    all.first_point.cell)};
  if (all.comma_or == 0) return NumberStyle{'.', apart};
  if (all.point > 0 || (all.point_or > 0 && separator == ',')) return NumberStyle{'.', ','};
  // 28.417 and 1,100: each mark may be either.
  if (all.point_or > 0) return marks_differ(all.first_point, all.first_ambiguous);
  // Every comma stands before three digits: decimals would be cut off nowhere but in whole numbers.
  if (has_mixed_column) return NumberStyle{'.', ','};
  // A comma that separates cells too is as likely a mark of thousands, in whatever column.
  if (separator != ',') return NumberStyle{',', '\0'};
  // In so many cells of several columns some thousands would be below 1000, or above a million.
  if (columns_of_commas > 1 && all.comma_or >= cells_of_decimals && bare == 0)
    return NumberStyle{',', '\0'};
  return StyleQuestion{all.first_ambiguous.row,
                       fmt::format("'{}' may be a decimal comma or thousands; say --decimal comma "
                                   "or --thousands comma",
                                   all.first_ambiguous.cell)};
}

CellFormat find_format(std::span<const std::string_view> cells, const std::string& column,
                       NumberStyle style, const CellOptions& options) {
  CellFormat format;
  format.style = style;
  format.missing = options.missing;
  std::size_t filled = 0, numbers = 0, plain = 0, suffixed = 0, flagged = 0;
  std::map<std::string, std::size_t, std::less<>> suffixes;
  std::set<std::string> words;
  unsigned spelling = 0;
  for (std::string_view cell : cells) {
    cell = trimmed(cell);
    if (cell.empty() || is_missing(cell, options.missing)) continue;
    ++filled;
    const auto number = read_number(cell, style);
    const bool is_state = coded_state(cell).has_value();
    if (number ? is_no_measurement(number->value) : means_no_value(cell)) format.no_value = cell;
    if (!number || is_state) {
      if (words.size() < most_states) words.insert(std::string(cell));
      continue;
    }
    ++numbers;
    if (number->spelling == 0) ++plain;
    spelling |= number->spelling;
    if (number->suffix.empty()) continue;
    ++suffixed;
    if (is_flag(number->suffix)) ++flagged;
    ++suffixes[std::string(number->suffix)];
  }
  if (filled == 0) return format;
  if (numbers == 0) {
    format.states =
        words.size() < most_states ? states_of(words, given_states(options, column)) : StateMap{};
    format.kind = format.states.empty() ? CellFormat::Kind::text : CellFormat::Kind::state;
    format.may_be_states = words.size() < most_states;
    const StateMap* const given = given_states(options, column);
    for (const std::string& word : words)
      if (format.words.size() < words_shown && !(given && has_state(*given, word)))
        format.words.push_back(word);
    return format;
  }
  format.kind = CellFormat::Kind::number;
  if (plain == numbers && style.decimal == '.') return format;
  const auto share = [&](std::size_t count) {
    return static_cast<double>(count) / static_cast<double>(numbers);
  };
  const bool one_unit = suffixes.size() == 1 && share(suffixed) >= agreement;
  if (one_unit && !(flagged == suffixed && suffixed < numbers))
    format.unit = suffixes.begin()->first;
  if (!one_unit && flagged != suffixed) spelling &= ~static_cast<unsigned>(with_suffix);
  format.spelling = spelling;
  if (format.unit.empty() && suffixed > 0 && flagged != suffixed && share(plain) < 0.5 * agreement)
    format.spelling &= ~static_cast<unsigned>(with_suffix);
  return format;
}

Cell read_cell(std::string_view text, const CellFormat& format) {
  if (!format.missing.empty() && is_missing(trimmed(text), format.missing))
    return {Cell::Kind::missing, 0, false};
  if (format.kind == CellFormat::Kind::state) {
    const std::string_view word = trimmed(text);
    if (word.empty()) return {};
    for (const auto& [state, value] : format.states)
      if (state == word) return {Cell::Kind::number, value, false};
    return {Cell::Kind::bad, 0, false};
  }
  if (format.spelling == 0 && format.style.decimal == '.') {
    if (const auto value = plain_number(text))
      return {is_no_measurement(*value) ? Cell::Kind::missing : Cell::Kind::number, *value, false};
    const std::string_view word = trimmed(text);
    if (!format.no_value.empty() && means_no_value(word)) return {Cell::Kind::missing, 0, false};
    return {word.empty() ? Cell::Kind::blank : Cell::Kind::bad, 0, false};
  }
  if (trimmed(text).empty()) return {};
  if (!format.no_value.empty() && means_no_value(trimmed(text)))
    return {Cell::Kind::missing, 0, false};
  const auto number = read_number(text, format.style);
  if (!number || (number->spelling & ~(format.spelling | grouped | decimal_comma)) != 0)
    return {Cell::Kind::bad, 0, false};
  if (is_no_measurement(number->value)) return {Cell::Kind::missing, 0, false};
  const bool is_flagged = !number->suffix.empty() && number->suffix != format.unit;
  if (is_flagged && !is_flag(number->suffix)) return {Cell::Kind::bad, 0, false};
  return {Cell::Kind::number, number->value, is_flagged};
}

std::string describe(const CellFormat& format) {
  if (format.kind == CellFormat::Kind::state) return states_text(format.states);
  if (format.kind != CellFormat::Kind::number) return {};
  std::string text;
  const auto add = [&](bool is_there, std::string_view what) {
    if (is_there) text += fmt::format("{}{}", text.empty() ? "" : ", ", what);
  };
  add((format.spelling & in_brackets) != 0, "numbers in brackets are negative");
  add((format.spelling & hexadecimal) != 0, "hexadecimal");
  add((format.spelling & fortran) != 0, "exponents with D");
  add((format.spelling & true_minus) != 0, "U+2212 is minus");
  add((format.spelling & in_formula) != 0, "numbers as formulas");
  add((format.spelling & power_apart) != 0, "powers of ten behind numbers");
  add(!format.unit.empty(), fmt::format("in {}", format.unit));
  add(!format.no_value.empty(), fmt::format("{} is no value", format.no_value));
  add((format.spelling & with_suffix) != 0 && format.unit.empty(),
      "flags of limits behind numbers");
  return text;
}

}  // namespace reident::telemetry_file
