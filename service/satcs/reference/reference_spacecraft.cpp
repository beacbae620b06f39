#include "service/satcs/reference/reference_spacecraft.hpp"

#include <chrono>
#include <utility>

namespace reident::satcs::reference {

storage::Time whole_seconds(storage::Time time) {
  using std::chrono::nanoseconds;
  return nanoseconds(std::chrono::floor<std::chrono::seconds>(nanoseconds(time))).count();
}

Spacecraft::Spacecraft(const Constants& fresh, std::vector<LifeEvent> life, storage::Time start,
                       std::uint64_t seed)
    : SensedPlant(Plant(fresh, std::move(life), whole_seconds(start), seed), telemetry_points(),
                  seed) {}

}  // namespace reident::satcs::reference
