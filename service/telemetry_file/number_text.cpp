#include "service/telemetry_file/number_text.hpp"

#include <algorithm>
#include <charconv>

#include "service/support/text.hpp"

namespace reident::telemetry_file {
namespace {

constexpr std::array<std::string_view, 3> wide_blanks = {"\xC2\xA0", "\xE2\x80\xAF",
                                                         "\xE2\x80\x89"};
constexpr std::string_view typographic_apostrophe = "\xE2\x80\x99";
constexpr std::array<std::string_view, 2> minuses = {"\xE2\x88\x92", "\xE2\x80\x93"};
constexpr std::size_t longest_suffix = 12;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_ascii(char c) {
  return (c & 0x80) == 0;
}

std::string_view without_blanks(std::string_view text) {
  text = trimmed(text);
  if (text.empty() || (is_ascii(text.front()) && is_ascii(text.back()))) return text;
  for (const std::string_view blank : wide_blanks) {
    while (text.starts_with(blank)) text.remove_prefix(blank.size());
    while (text.ends_with(blank)) text.remove_suffix(blank.size());
  }
  return trimmed(text);
}

/// Takes a sign off the front: -1, 1, or 0 where there is none.
int take_sign(std::string_view& text, unsigned& spelling) {
  if (text.starts_with('-') || text.starts_with('+')) {
    const int sign = text.front() == '-' ? -1 : 1;
    text.remove_prefix(1);
    while (text.starts_with(' ')) text.remove_prefix(1);  // as loggers align numbers
    return sign;
  }
  if (text.empty() || is_ascii(text.front())) return 0;
  for (const std::string_view minus : minuses)
    if (text.starts_with(minus)) {
      text.remove_prefix(minus.size());
      spelling |= true_minus;
      return -1;
    }
  return 0;
}

/// Takes a mark between groups off the front; empty where none is there.
std::string_view group_mark(std::string_view text, char thousands) {
  if (text.empty()) return {};
  if (thousands == ' ' && !is_ascii(text.front())) {
    for (const std::string_view blank : wide_blanks)
      if (text.starts_with(blank)) return text.substr(0, blank.size());
  }
  if (thousands == '\'' && text.starts_with(typographic_apostrophe))
    return text.substr(0, typographic_apostrophe.size());
  if (thousands != '\0' && text.starts_with(thousands)) return text.substr(0, 1);
  return {};
}

std::size_t leading_digits(std::string_view text) {
  return static_cast<std::size_t>(std::find_if_not(text.begin(), text.end(), is_digit) -
                                  text.begin());
}

/// Digits before the decimal mark, groups joined; false where groups are not of three.
bool take_whole_part(std::string_view& text, NumberStyle style, std::string& plain,
                     unsigned& spelling) {
  const std::size_t first = leading_digits(text);
  plain += text.substr(0, first);
  text.remove_prefix(first);
  while (true) {
    const std::string_view mark = group_mark(text, style.thousands);
    const std::size_t digits = leading_digits(text.substr(mark.size()));
    if (mark.empty() || digits == 0) return true;
    if (digits != 3 || first == 0 || first > 3) return style.thousands == ' ';
    plain += text.substr(mark.size(), 3);
    text.remove_prefix(mark.size() + 3);
    spelling |= grouped;
  }
}

bool take_exponent(std::string_view& text, std::string& plain, unsigned& spelling) {
  if (text.empty()) return false;
  const char c = text.front();
  const bool d = c == 'D' || c == 'd';
  if (!d && c != 'E' && c != 'e') return false;
  std::size_t at = 1;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) ++at;
  const std::size_t digits = leading_digits(text.substr(at));
  // 6D91 is hexadecimal.
  if (digits == 0 || (d && at == 1 && plain.find('.') == std::string::npos)) return false;
  plain += 'e';
  plain += text.substr(text[1] == '+' ? 2 : 1, at + digits - (text[1] == '+' ? 2 : 1));
  text.remove_prefix(at + digits);
  if (d) spelling |= fortran;
  return true;
}

/// Takes a power of ten that stands apart, as in 5.8 E-3 and 5.8x10^-3, where nothing is behind it.
void take_power(std::string_view& text, std::string& plain, unsigned& spelling) {
  std::string_view rest = without_blanks(text);
  std::string power = plain;
  if (!take_exponent(rest, power, spelling)) {
    constexpr std::array<std::string_view, 4> times = {"\xC3\x97", "\xC2\xB7", "x", "*"};
    const auto sign = std::find_if(times.begin(), times.end(),
                                   [&](std::string_view one) { return rest.starts_with(one); });
    if (sign == times.end()) return;
    rest = without_blanks(rest.substr(sign->size()));
    if (!rest.starts_with("10")) return;
    rest.remove_prefix(2);
    if (rest.starts_with('^')) rest.remove_prefix(1);
    const int of_power = take_sign(rest, spelling);
    const std::size_t digits = leading_digits(rest);
    power += (of_power < 0 ? "e-" : "e") + std::string(rest.substr(0, digits));
    if (digits == 0) return;
    rest.remove_prefix(digits);
  }
  if (!without_blanks(rest).empty()) return;
  text = {};
  plain = power;
  spelling |= power_apart;
}

std::optional<double> converted(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<NumberText> read_hexadecimal(std::string_view text, int sign) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data() + 2, text.data() + text.size(), value, 16);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return NumberText{(sign < 0 ? -1 : 1) * static_cast<double>(value), hexadecimal, {}};
}

bool may_be_suffix(std::string_view text) {
  constexpr std::string_view firsts = "%*!#?([";
  const char c = text.front();
  const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c & 0x80) != 0;
  return text.size() <= longest_suffix && (is_letter || firsts.find(c) != std::string_view::npos) &&
         text.find_first_of("\",;:") == std::string_view::npos &&
         std::none_of(text.begin(), text.end(),
                      [](char at) { return at >= 0 && static_cast<unsigned char>(at) < 0x20; });
}

/// Whether another number follows, as in 28. Februar 2024; an exponent is none.
bool is_more_than_a_suffix(std::string_view text) {
  std::string ignored;
  unsigned spelling = 0;
  take_exponent(text, ignored, spelling);
  for (std::size_t i = 1; i < text.size(); ++i)
    if (is_digit(text[i - 1]) && is_digit(text[i])) return true;
  return false;
}

}  // namespace

std::optional<double> plain_number(std::string_view cell) {
  cell = trimmed(cell);
  if (cell.size() > 1 && cell[0] == '+' && cell[1] != '-') cell = trimmed(cell.substr(1));
  if (cell.size() > 1 && cell[0] == '-' && cell[1] == ' ') {
    const auto value = converted(trimmed(cell.substr(1)));
    return value && *value >= 0 ? std::optional(-*value) : std::nullopt;
  }
  return converted(cell);
}

std::optional<NumberText> read_number(std::string_view cell, NumberStyle style) {
  if (style.decimal == '.' || cell.find('.') == std::string_view::npos)
    if (const auto value = plain_number(cell)) return NumberText{*value, 0, {}};
  std::string_view text = without_blanks(cell);
  NumberText read;
  if (text.size() < trimmed(cell).size()) read.spelling |= in_wide_blanks;
  if (text.size() > 3 && text.starts_with("=\"") && text.ends_with('"')) {
    read.spelling |= in_formula;
    text = without_blanks(text.substr(2, text.size() - 3));
  }
  bool brackets = false;
  if (text.size() > 2 && text.front() == '(' && text.back() == ')') {
    brackets = true;
    read.spelling |= in_brackets;
    text = without_blanks(text.substr(1, text.size() - 2));
  }
  const int sign = take_sign(text, read.spelling);
  text = without_blanks(text);
  if (text.empty() || (brackets && sign != 0)) return std::nullopt;
  if (text.starts_with("0x") || text.starts_with("0X")) return read_hexadecimal(text, sign);
  std::string plain = sign < 0 || brackets ? "-" : "";
  const std::size_t before = plain.size();
  if (!take_whole_part(text, style, plain, read.spelling)) return std::nullopt;
  if (!text.empty() && text.front() == style.decimal) {
    text.remove_prefix(1);
    plain += '.';
    const std::size_t digits = leading_digits(text);
    plain += text.substr(0, digits);
    text.remove_prefix(digits);
    if (style.decimal == ',') read.spelling |= decimal_comma;
  }
  if (plain.find_first_of("0123456789", before) == std::string::npos) return std::nullopt;
  if (!take_exponent(text, plain, read.spelling)) take_power(text, plain, read.spelling);
  const auto value = converted(plain);
  if (!value) return std::nullopt;
  read.value = *value;
  text = without_blanks(text);
  if (text.empty()) return read;
  if (!may_be_suffix(text)) return std::nullopt;
  read.suffix = text;
  read.spelling |= with_suffix;
  return read;
}

bool may_be_hexadecimal(std::string_view cell) {
  cell = trimmed(cell);
  return cell.size() > 1 && cell.find_first_of("0123456789") != std::string_view::npos &&
         cell.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

bool is_flag(std::string_view suffix) {
  constexpr std::array<std::string_view, 19> flags = {
      "H", "L",  "HH", "LL", "HI",  "LO",     "HIHI", "LOLO", "*", "**",
      "!", "!!", "R",  "Y",  "RED", "YELLOW", "OOL",  "#",    "?"};
  return std::find(flags.begin(), flags.end(), suffix) != flags.end();
}

std::optional<MarkEvidence> marks_in(std::string_view cell) {
  std::string_view text = without_blanks(cell);
  unsigned ignored = 0;
  if (text.starts_with('(') && text.ends_with(')')) text = text.substr(1, text.size() - 2);
  take_sign(text, ignored);
  MarkEvidence evidence;
  std::string marks;  // the digits between them are `groups`
  std::array<std::size_t, 12> groups{};
  std::size_t count = 0;
  while (count < groups.size()) {
    groups[count] = leading_digits(text);
    text.remove_prefix(groups[count++]);
    std::string_view mark;
    char as = '\0';
    for (const char c : {' ', '\'', '.', ','})
      if (mark.empty() && !(mark = group_mark(text, c)).empty()) as = c;
    const std::size_t next = leading_digits(text.substr(mark.size()));
    if (as == '\0' || (next == 0 && as != '.' && as != ',')) break;
    if (as == ' ' && next != 3) break;  // a unit, or the next thing
    text.remove_prefix(mark.size());
    marks += as;
  }
  if (groups[0] == 0 && (marks.empty() || groups[1] == 0)) return std::nullopt;
  if (!text.empty() && is_digit(text.front())) return std::nullopt;
  if (is_more_than_a_suffix(text)) return std::nullopt;
  const auto apart = marks.find_first_of(" '");
  if (apart != std::string::npos) evidence.blank_group = marks[apart];
  std::erase_if(marks, [](char c) { return c == ' ' || c == '\''; });
  if (marks.empty()) return evidence;
  const bool points = marks.find('.') != std::string::npos,
             commas = marks.find(',') != std::string::npos;
  if (points && commas) {
    const char last = marks.back();
    if (std::count(marks.begin(), marks.end(), last) != 1) return std::nullopt;
    evidence.mark = Mark::both;
    evidence.style = {last, last == '.' ? ',' : '.'};
    return evidence;
  }
  const bool alone = marks.size() == 1 && evidence.blank_group == '\0';
  const bool could_group = alone && groups[1] == 3 && groups[0] >= 1 && groups[0] <= 3 &&
                           text.empty() && !without_blanks(cell).starts_with("0");
  if (marks.size() > 1) {  // 1,234,567
    if (std::any_of(groups.begin() + 1, groups.begin() + static_cast<std::ptrdiff_t>(count),
                    [](std::size_t digits) { return digits != 3; }))
      return std::nullopt;
    evidence.mark = Mark::both;
    evidence.style = points ? NumberStyle{',', '.'} : NumberStyle{'.', ','};
    return evidence;
  }
  const bool leading_zero = groups[0] > 0 &&
                            cell.find_first_of("0123456789") != std::string_view::npos &&
                            cell[cell.find_first_of("0123456789")] == '0';
  if (could_group && !leading_zero)
    evidence.mark = points ? Mark::point_or_thousands : Mark::comma_or_thousands;
  else
    evidence.mark = points ? Mark::point : Mark::comma;
  return evidence;
}

}  // namespace reident::telemetry_file
