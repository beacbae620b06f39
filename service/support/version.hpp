// Which program made a result.
#pragma once

#include <string_view>

namespace reident {

/// Returns text such as "0.1.0+91e4a90d1c2b", with the commit that it was built from where that is
/// known ("-dirty": and changes to it); every attempt and version records it.
std::string_view program_version();

}  // namespace reident
