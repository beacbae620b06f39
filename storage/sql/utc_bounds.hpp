// Conditions on times as texts. utc_text() gives texts of one length whose order is that of the
// times, so that a comparison with any text is one with a time.
#pragma once

#include <optional>
#include <string_view>

#include "storage/types/telemetry.hpp"

namespace reident::storage::sql {

/// The first time whose text is not below `text` by its bytes; none where all are below. So
/// "2026-03-01" stands for the begin of that day.
std::optional<Time> first_time_from(std::string_view text);

}  // namespace reident::storage::sql
