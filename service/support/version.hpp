#pragma once

#include <string_view>

namespace reident {

/// Such as "0.1.0"; every attempt and version records it.
std::string_view program_version();

}  // namespace reident
