#include "service/telemetry_file/date_spelling.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "service/support/text.hpp"

namespace reident::telemetry_file {
namespace {

struct Spelling {
  std::string_view word, plain;
};

/// What stands for a part of a date wherever it stands.
constexpr std::array<Spelling, 11> signs = {{{"\xE5\xB9\xB4", "-"},    // year
                                             {"\xE6\x9C\x88", "-"},    // month
                                             {"\xE6\x97\xA5", " "},    // day
                                             {"\xE6\x99\x82", ":"},    // hour
                                             {"\xE6\x97\xB6", ":"},    // hour, simplified
                                             {"\xE5\x88\x86", ":"},    // minute
                                             {"\xE7\xA7\x92", " "},    // second
                                             {"\xC2\xA0", " "},        // no break
                                             {"\xE2\x80\xAF", " "},    // narrow, no break
                                             {"\xE2\x80\x89", " "},    // thin
                                             {"\xE3\x80\x80", " "}}};  // ideographic

/// Words for the halves of a day, in front of the clock or behind it.
constexpr std::array<Spelling, 10> halves = {{{"\xEC\x98\xA4\xEC\xA0\x84", "am"},  // Korean
                                              {"\xEC\x98\xA4\xED\x9B\x84", "pm"},  //
                                              {"\xE4\xB8\x8A\xE5\x8D\x88", "am"},  // Chinese
                                              {"\xE4\xB8\x8B\xE5\x8D\x88", "pm"},  //
                                              {"\xE5\x8D\x88\xE5\x89\x8D", "am"},  // Japanese
                                              {"\xE5\x8D\x88\xE5\xBE\x8C", "pm"},  //
                                              {"\xCF\x80\xCE\xBC", "am"},          // Greek
                                              {"\xCE\xBC\xCE\xBC", "pm"},          //
                                              {"\xCF\x80.\xCE\xBC.", "am"},        //
                                              {"\xCE\xBC.\xCE\xBC.", "pm"}}};

/// What days of the week begin with, in English, German, French, Spanish, Portuguese, Italian; the
/// two letters of German.
constexpr std::string_view weekdays =
    " mon tue wed thu fri sat sun die mit don fre sam son lun mar mer jeu ven dim mi\xC3\xA9 mie "
    "jue vie s\xC3\xA1"
    "b sab dom gio seg ter qua qui sex mo di mi do fr sa so ";

bool digit_at(std::string_view text, std::size_t at) {
  return at < text.size() && text[at] >= '0' && text[at] <= '9';
}

template <std::size_t count>
void replace_all(std::string& text, const std::array<Spelling, count>& spellings) {
  for (const auto& [word, plain] : spellings)
    for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at))
      text.replace(at, word.size(), plain);
}

/// Puts a word for a half of the day behind the clock, as AM or PM.
void mend_half(std::string& text) {
  for (const auto& [word, plain] : halves)
    if (const auto at = text.find(word); at != std::string::npos) {
      text.replace(at, word.size(), " ");
      text = std::string(trimmed(text)) + " " + std::string(plain);
      return;
    }
  const auto digits_end = text.find_last_of("0123456789") + 1;
  std::string letters;
  for (const char c : text.substr(digits_end))
    if (c != '.' && c != ' ') letters += static_cast<char>(c | 0x20);
  if (letters == "am" || letters == "pm") text = text.substr(0, digits_end) + " " + letters;
  if (letters == "uhr" || letters == "hrs") text.resize(digits_end);
}

/// A zone in brackets behind the time; behind an offset it says nothing more.
void mend_brackets(std::string& text) {
  if (!text.ends_with(')') && !text.ends_with(']')) return;
  const auto open = text.find_last_of("([");
  if (open == std::string::npos) return;
  const std::string zone = text.substr(open + 1, text.size() - open - 2);
  text = std::string(trimmed(text.substr(0, open)));
  const auto sign = text.find_last_of("+-");
  const bool has_offset =
      text.ends_with('Z') ||
      (sign != std::string::npos && text.find(':') != std::string::npos && sign > text.find(':'));
  if (!has_offset) text += " " + zone;
}

void drop_weekday(std::string& text) {
  const auto end = text.find_first_of(" ,.");
  if (end == std::string::npos || end < 2 || digit_at(text, 0)) return;
  std::string word = text.substr(0, end);
  for (char& c : word)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c | 0x20);
  const auto begins_with = [&](std::size_t letters) {
    return word.size() >= letters &&
           weekdays.find(" " + word.substr(0, letters) + " ") != std::string_view::npos;
  };
  // Mar 28 is a day of March, mar. 28/02/2024 a Tuesday.
  if (word == "mar" && text.find_first_of("/-", end) == std::string::npos) return;
  if ((word.size() == 2 && begins_with(2)) || begins_with(3) || begins_with(4))
    text.erase(0, std::min(text.find_first_not_of(" ,.", end), text.size()));
}

/// 2024. 2. 28. 22:00 as 2024.2.28 22:00.
void mend_points(std::string& text) {
  if (text.find(". ") != 4) return;
  for (int part = 0; part < 3; ++part) {
    const auto at = text.find(". ");
    if (at == std::string::npos) break;
    text.replace(at, 2, part < 2 ? "." : " ");
  }
  if (text.ends_with('.')) text.pop_back();
}

/// 22h00m30s and 22-00-30 with colons.
void mend_clock(std::string& text) {
  const auto blank = text.find_last_of(" Tt_");
  const std::size_t begin = blank == std::string::npos ? 0 : blank + 1;
  const bool has_dashes =
      begin > 0 && text.size() == begin + 8 && text[begin + 2] == '-' && text[begin + 5] == '-';
  if (has_dashes) text[begin + 2] = text[begin + 5] = ':';
  const auto hour = text.find('h', begin);
  if (hour == std::string::npos || !digit_at(text, hour - 1) || !digit_at(text, hour + 1)) return;
  text[hour] = ':';
  if (text.ends_with('s')) text.pop_back();
  for (const std::string_view minute : {"min", "mn", "m"})
    if (const auto at = text.find(minute, hour); at != std::string::npos) {
      text.replace(at, minute.size(), at + minute.size() < text.size() ? ":" : "");
      return;
    }
}

/// 22:00:30 28.02.2024 with the date first.
void mend_order(std::string& text) {
  const auto blank = text.find(' '), colon = text.find(':');
  if (blank == std::string::npos || colon > blank || !digit_at(text, 0)) return;
  const std::string rest(trimmed(text.substr(blank)));
  if (digit_at(rest, 0) && rest.find(':') == std::string::npos)
    text = rest + " " + text.substr(0, blank);
}

}  // namespace

std::string plain_spelling(std::string_view cell) {
  std::string text(trimmed(cell));
  replace_all(text, signs);
  text = std::string(trimmed(text));
  if (text.starts_with("=\"") && text.ends_with('"')) text = text.substr(2, text.size() - 3);
  if (text.starts_with('\'')) text.erase(0, 1);
  if (text.find_first_of("0123456789") == std::string::npos) return text;
  for (const std::string_view days : {" days ", " day "})  // 2 days 22:00:30
    if (const auto at = text.find(days); at != std::string::npos && digit_at(text, 0))
      text.replace(at, days.size(), " ");
  if (const auto comma = text.find(','); comma < text.find(':') && digit_at(text, comma - 1))
    text[comma] = ' ';  // 28.2.2024, 22:00
  mend_half(text);
  mend_brackets(text);
  drop_weekday(text);
  mend_points(text);
  mend_clock(text);
  mend_order(text);
  return text;
}

}  // namespace reident::telemetry_file
