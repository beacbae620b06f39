// Names with * and ?.
#pragma once

#include <string_view>

namespace reident {

/// Whether `name` is as `pattern` says: * stands for any text, also none, and ? for one character
/// (a code point of UTF-8); everything else stands for itself. A name without * and ? matches
/// itself alone. Not fnmatch(3): there a bracket begins a set and a backslash an escape, both of
/// which names may have, and ? is a byte or a character by the locale of the program. Takes time
/// proportional to the product of the lengths at most, and allocates nothing.
bool matches(std::string_view pattern, std::string_view name);

}  // namespace reident
