// Telemetry of the archive as CSV text, as a stream: memory does not grow with the archive.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "service/history/sources.hpp"
#include "service/support/csv.hpp"
#include "storage/archive/holdings.hpp"

namespace reident::transfer {

struct ExportOptions {
  /// All of them where nothing is named.
  std::optional<std::string> spacecraft;
  std::optional<storage::Origin> origin;
  std::vector<std::string> parameters;  // in this order where `wide`
  storage::TimeRange range;
  /// A row for each time instead of one for each sample: one spacecraft and origin.
  bool wide = false;
};

struct ExportProgress {
  double fraction = 0;  // of the samples that the series hold
  std::uint64_t samples = 0;
};

struct ExportReport {
  std::uint64_t series = 0;
  std::uint64_t samples = 0;
  std::uint64_t rows = 0;
  bool complete = false;  // false: the observer stopped it
};

/// Takes a piece of the text; throws when it cannot be written.
using TextSink = std::function<void(std::string_view)>;
/// False stops the export there.
using ExportObserver = std::function<bool(const ExportProgress&)>;

/// The series to be exported, or what is wrong with the request.
std::variant<std::vector<storage::SeriesInfo>, csv::Error> series_to_export(
    const history::TelemetrySource& telemetry, const ExportOptions& options);

/// Writes header and rows. Long: series after series, each in order of time. Samples that come
/// while it runs may be among them or not.
ExportReport export_series(const history::TelemetrySource& telemetry,
                           const std::vector<storage::SeriesInfo>& series,
                           const ExportOptions& options, const TextSink& sink,
                           const ExportObserver& observer);

}  // namespace reident::transfer
