// Telemetry of the archive as CSV text, as a stream: memory does not grow with the archive.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "service/history/readers.hpp"
#include "service/support/csv.hpp"
#include "storage/archive/holdings.hpp"

namespace reident::transfer {

/// What is exported, and in which layout (telemetry_csv.hpp).
struct ExportOptions {
  /// What is not named is not restricted.
  std::optional<std::string> spacecraft;
  std::optional<storage::Origin> origin;
  std::vector<std::string> parameters;  // in this order where `wide`
  storage::TimeRange range;             // generation times with begin <= time < end
  /// A row for each time instead of one for each sample: one spacecraft and origin.
  bool wide = false;
};

/// How far it is; the samples of `range` are not known beforehand.
struct ExportProgress {
  double fraction = 0;  // of the samples that the series hold
  std::uint64_t samples = 0;
};

/// What was written.
struct ExportReport {
  std::uint64_t series = 0;
  std::uint64_t samples = 0;
  std::uint64_t rows = 0;
  bool complete = false;  // false: the observer stopped it
};

/// Takes a piece of the text, some 256 KiB; throws when it cannot be written.
using TextSink = std::function<void(std::string_view)>;
/// Called every few thousand samples; false stops the export there.
using ExportObserver = std::function<bool(const ExportProgress&)>;

/// Returns the series to be exported, in their order; or what is wrong with the request: a
/// spacecraft or parameter that the archive does not have, or more than one spacecraft or origin,
/// or two parameters of one name, where `wide`. Throws as TelemetryReader does.
std::variant<std::vector<storage::SeriesInfo>, csv::Error> series_to_export(
    const history::TelemetryReader& telemetry, const ExportOptions& options);

/// Writes header and rows. Long: series after series, each in order of time. Samples that come
/// while it runs may be among them or not. Requires series of series_to_export() with the same
/// options. Throws what the reader and the sink throw; what was written till then stays written.
ExportReport export_series(const history::TelemetryReader& telemetry,
                           const std::vector<storage::SeriesInfo>& series,
                           const ExportOptions& options, const TextSink& sink,
                           const ExportObserver& observer);

}  // namespace reident::transfer
