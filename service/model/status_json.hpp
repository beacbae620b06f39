// A service's heartbeat as programs read it, at the console and on the page.
#pragma once

#include <cstdint>
#include <optional>

#include <nlohmann/json.hpp>

#include "service/model/messages.hpp"

namespace reident {

/// Whether all that came in is dealt with.
bool is_idle(const ServiceStatus& status);

/// Whole days until the service's certificate ends, by the service's clock; below 0 once it has
/// ended. Absent where the domain is not secured.
std::optional<std::int64_t> certificate_days(const ServiceStatus& status);

/// Returns all of it; times are texts of UTC. `pair` is there for a service of a pair alone, and
/// its `lag` is null where it is not known.
nlohmann::ordered_json status_json(const ServiceStatus& status);

/// Returns what `status_json` has of the place of a service in its pair, with the service's name.
nlohmann::ordered_json pair_json(const ServiceStatus& status);

}  // namespace reident
