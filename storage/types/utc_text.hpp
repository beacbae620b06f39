// Times for people.
#pragma once

#include <string>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// ISO 8601 with nanoseconds: 2023-04-29T12:00:00.000000000Z.
std::string utc_text(Time time);

}  // namespace reident::storage
