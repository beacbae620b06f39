// Dates and times as single countries and programs spell them, in the spelling that all know.
#pragma once

#include <string>
#include <string_view>

namespace reident::telemetry_file {

/// Returns the text as date_text.hpp reads it, where it is one of these:
///   2024\u5E7402\u670828\u65E5 22\u6642, 2024. 2. 28. 22:00, 22h00m30s, 22:00 Uhr, 22-00-30
///   10:00 p. m., \uC624\uD6C4 10:00, \u4E0B\u5348 10:00 and other words for the halves of a day
///   Mi 28.02.2024, mer. 28/02/2024: days of the week in six languages
///   22:00:30 28.02.2024, '2024-02-28, 22:00 (UTC), and wide blanks
/// Another text comes back without its wide blanks, and may have other changes.
std::string plain_spelling(std::string_view cell);

}  // namespace reident::telemetry_file
