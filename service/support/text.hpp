// Small work on text. Bytes are compared: no locale plays a part.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace reident {

/// Returns the part of `text` without the blanks and tabs around it; it points into `text`. Line
/// ends stay.
constexpr std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Returns the names as in "a, b, c"; empty without names.
inline std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const auto& name : names) {
    if (!text.empty()) text += ", ";
    text += name;
  }
  return text;
}

/// The names of "a, b, c".
std::vector<std::string> split_names(std::string_view text);

/// Returns the candidate that is least different from `name`, as one who misspelt it wrote it:
/// letters changed, left out, added or swapped, the case of letters aside; empty where none is
/// near.
std::string_view nearest(std::string_view name, const std::vector<std::string>& candidates);

/// " (did you mean X?)", or nothing where no candidate is near.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);

/// Returns the names that are none of `known`, each with did_you_mean(); empty where all are known.
std::string unknown_among(const std::vector<std::string>& names,
                          const std::vector<std::string>& known);

/// Returns the lines of a text, without their ends.
std::vector<std::string> lines_of(const std::string& text);

}  // namespace reident
