// What a question of the page names, read and checked.
#pragma once

#include <cstdint>
#include <optional>

#include "service/review/stored_version.hpp"
#include "service/web/query_pool.hpp"
#include "storage/types/time_bins.hpp"

namespace reident::web {

// Each throws BadRequest, with the remedy, for what is not there or cannot be read.

/// Parameters `spacecraft` and `equipment`, of an equipment with attempts.
storage::EquipmentName equipment_of(const Stored& stored, const HttpRequest& request);

/// Parameters `spacecraft`, `parameter` and `origin` (real where it is left out).
storage::SeriesInfo series_of(const Stored& stored, const HttpRequest& request);

/// Parameter `version`, of an equipment that is known.
StoredVersion version_of(const Stored& stored, const storage::EquipmentName& equipment,
                         const HttpRequest& request);

/// Parameters `begin` and `end`; one that is left out is that of `otherwise`.
storage::TimeRange range_of(const HttpRequest& request, storage::TimeRange otherwise);

/// A whole number from `least` to `most`; `otherwise` where it is left out.
std::int64_t number_of(const HttpRequest& request, std::string_view name, std::int64_t least,
                       std::int64_t most, std::int64_t otherwise);

/// The range in the bins that parameter `bins` asks for, each a whole number of milliseconds long.
storage::TimeBins bins_of(const HttpRequest& request, storage::TimeRange range);

/// Where decisions stand on the axis of telemetry: where the newest telemetry was when they were
/// made. Their own times are by the clock of the service, which may run through years of telemetry
/// in a day.
class TelemetryClock {
 public:
  /// `extent`: of the spacecraft's telemetry.
  explicit TelemetryClock(std::optional<storage::TimeRange> extent) : extent_(extent) {}
  /// Call for each decision of an equipment, in their order.
  storage::Time place_of(const storage::Decision& decision);

 private:
  std::optional<storage::TimeRange> extent_;
  std::optional<storage::Time> last_;
};

}  // namespace reident::web
