#include "service/support/text.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <sstream>
#include <utility>

namespace reident {
namespace {

char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

/// Edits that make one text of the other: a letter changed, added, left out, or two swapped
/// (optimal string alignment).
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last, last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (same ? 0U : 1U)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1]))
        now[j] = std::min(now[j], before_last[j - 2] + 1);
    }
    before_last = std::exchange(last, now);
  }
  return last[b.size()];
}

}  // namespace

std::vector<std::string> split_names(std::string_view text) {
  std::vector<std::string> names;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    names.emplace_back(trimmed(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return names;
}

std::string_view nearest(std::string_view name, const std::vector<std::string>& candidates) {
  constexpr std::size_t letters_of_an_edit = 3;  // a name of so many may differ by one
  std::string_view found;
  std::size_t least = std::max<std::size_t>(1, name.size() / letters_of_an_edit) + 1;
  for (const std::string& candidate : candidates)
    if (const std::size_t count = edits(name, candidate); count < least) {
      least = count;
      found = candidate;
    }
  return found;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string_view found = nearest(name, candidates);
  return found.empty() ? "" : " (did you mean " + std::string(found) + "?)";
}

std::string unknown_among(const std::vector<std::string>& names,
                          const std::vector<std::string>& known) {
  std::string text;
  for (const std::string& name : names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      text += (text.empty() ? "" : "; ") + name + did_you_mean(name, known);
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace reident
