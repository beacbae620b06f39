// How often something comes, as people write it: "100/s", "6/min", "1/h".
#pragma once

#include <optional>
#include <string_view>

namespace reident {

/// Per second; nullopt where the text is no such rate, or is not above 0.
std::optional<double> parse_rate(std::string_view text);

}  // namespace reident
