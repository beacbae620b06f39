// Times for people, in UTC.
#pragma once

#include <string>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// The time in ISO 8601 with nanoseconds: 2023-04-29T12:00:00.000000000Z. Every Time has such a
/// text. All are of 30 characters, so that texts sort as times do, and a beginning of one names the
/// day, hour or second.
std::string utc_text(Time time);

}  // namespace reident::storage
