#include "service/telemetry_file/name_words.hpp"

#include "service/support/text.hpp"

namespace reident::telemetry_file {

std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  char before = '\0';
  for (const char c : name) {
    const bool is_upper = c >= 'A' && c <= 'Z', is_lower = c >= 'a' && c <= 'z';
    const bool is_word = is_upper || is_lower || (c >= '0' && c <= '9') || (c & 0x80) != 0;
    const bool humps = is_upper && before >= 'a' && before <= 'z';
    if ((!is_word || humps) && !words.back().empty()) words.emplace_back();
    if (is_word) words.back() += static_cast<char>(is_upper ? c | 0x20 : c);
    before = c;
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::string_view bracketed(std::string_view name) {
  name = trimmed(name);
  if (!name.ends_with(')') && !name.ends_with(']')) return {};
  const auto open = name.find_last_of("([");
  return open == std::string_view::npos ? std::string_view()
                                        : trimmed(name.substr(open + 1, name.size() - open - 2));
}

}  // namespace reident::telemetry_file
