// Names of columns as words. Private to this folder.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace reident::telemetry_file {

/// "unix time [ms]" and "unixTimeMs" as unix, time, ms.
std::vector<std::string> words_of(std::string_view name);

/// What stands in brackets at the end of a name.
std::string_view bracketed(std::string_view name);

}  // namespace reident::telemetry_file
