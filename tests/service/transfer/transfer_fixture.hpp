// Archives filled from CSV text and compared with others.
#pragma once

#include <string>
#include <tuple>
#include <vector>

#include "service/history/stored_readers.hpp"
#include "service/transfer/export.hpp"
#include "service/transfer/import.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::transfer::test {

using storage::test::TemporaryFolder;

inline storage::ParameterDescriptor descriptor(const std::string& spacecraft, std::uint32_t id,
                                               const std::string& name, const std::string& unit) {
  storage::ParameterDescriptor made;
  made.spacecraft = spacecraft;
  made.id = id;
  made.name = name;
  made.unit = unit;
  return made;
}

inline storage::Time fixed_clock() {
  return 1'700'000'000'000'000'000;
}

inline bool go_on(const ImportProgress&) {
  return true;
}

inline std::variant<ImportReport, csv::Error> try_import(storage::Database& database,
                                                         const ImportOptions& options,
                                                         const ImportLimits& limits = {},
                                                         const ImportObserver& observer = go_on) {
  auto opened = telemetry_file::TelemetryFile::open(options.file, options.reading);
  if (auto* error = std::get_if<csv::Error>(&opened)) return std::move(*error);
  return import_file(database, std::get<telemetry_file::TelemetryFile>(opened), options,
                     fixed_clock, observer, limits);
}

/// Fails the test where the import does.
inline ImportReport import(storage::Database& database, const ImportOptions& options,
                           const ImportLimits& limits = {}) {
  auto result = try_import(database, options, limits);
  if (const auto* error = std::get_if<csv::Error>(&result)) {
    ADD_FAILURE() << error->message;
    return {};
  }
  return std::get<ImportReport>(result);
}

inline ExportOptions everything() {
  ExportOptions options;
  options.range = {std::numeric_limits<storage::Time>::min(),
                   std::numeric_limits<storage::Time>::max()};
  return options;
}

/// The text of an export; the message where the request is refused.
inline std::string exported(storage::Database& database,
                            const ExportOptions& options = everything()) {
  const history::StoredTelemetry telemetry(database);
  const auto series = series_to_export(telemetry, options);
  if (const auto* error = std::get_if<csv::Error>(&series)) return error->message;
  std::string text;
  export_series(
      telemetry, std::get<std::vector<storage::SeriesInfo>>(series), options,
      [&text](std::string_view piece) { text += piece; },
      [](const ExportProgress&) { return true; });
  return text;
}

}  // namespace reident::transfer::test
