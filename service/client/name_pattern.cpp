#include "service/client/name_pattern.hpp"

namespace reident {
namespace {

/// Without its first character.
std::string_view after_first(std::string_view text) {
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; };
  text.remove_prefix(1);
  while (!text.empty() && continues(text.front())) text.remove_prefix(1);
  return text;
}

}  // namespace

bool matches(std::string_view pattern, std::string_view name) {
  // Where the last * left off: what follows it, and the text that it has not taken yet. An earlier
  // * never has to take more once a later one was reached.
  bool has_star = false;
  std::string_view after_star, untaken;
  while (!name.empty()) {
    if (!pattern.empty() && pattern.front() == '*') {
      has_star = true;
      after_star = pattern = pattern.substr(1);
      untaken = name;
    } else if (!pattern.empty() && pattern.front() == '?') {
      pattern.remove_prefix(1);
      name = after_first(name);
    } else if (!pattern.empty() && pattern.front() == name.front()) {
      pattern.remove_prefix(1);
      name.remove_prefix(1);
    } else if (has_star) {
      pattern = after_star;
      name = untaken = after_first(untaken);
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*') == std::string_view::npos;
}

}  // namespace reident
