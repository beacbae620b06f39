// Which files were imported, and how far: kept with the samples, in their transactions.
//
// An import that was killed goes on where its last transaction ended. Nothing is lost by starting
// again instead: samples that are there already are counted as duplicates.
//
// The log knows nothing of the file's format. Request and digest are texts of the importer, by
// which it finds its own imports again.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/archive/archive.hpp"

namespace reident::storage {

/// How far an import is. Samples are counted once each: stored + duplicates + conflicts. The
/// importer sets what concerns the file; append() adds what became of the samples.
struct ImportPosition {
  std::uint64_t position = 0;  // bytes of the file that are in the archive
  std::uint64_t line = 1;      // of the next row
  std::string digest;          // of the file's bytes before `position`, as the importer makes it
  std::uint64_t rows = 0;
  std::uint64_t bad_lines = 0;  // left out
  std::uint64_t samples = 0;
  std::uint64_t stored = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t conflicts = 0;
};

/// The imports of one database, which is opened for writing but for unfinished().
class ImportLog {
 public:
  /// The database must outlive the log.
  explicit ImportLog(Database& database);

  /// An import that was begun and not finished.
  struct Unfinished {
    std::int64_t id = 0;
    ImportPosition at;
  };
  /// Imports with this very `request` (what was asked for, in the importer's words) that did not
  /// come to their end, the last one first. Whether the file is still the same is the importer's to
  /// check, by the digest.
  std::vector<Unfinished> unfinished(const std::string& request) const;

  /// Stores that an import of `file` begins. Returns its id.
  std::int64_t begin(const std::string& file, const std::string& request, Time now);
  /// Describes the parameters, appends the frames, adds what became of their samples to the counts
  /// of `at`, and keeps `at`, all in one transaction. Throws Error where it cannot; then nothing is
  /// stored and `at` is as it was.
  AppendReport append(std::int64_t import, std::span<const ParameterDescriptor> descriptors,
                      std::span<const TelemetryFrame> frames, ImportPosition& at);
  /// Stores that the import came to its end: unfinished() does not give it any more.
  void finish(std::int64_t import, Time now);

 private:
  Database& database_;
};

}  // namespace reident::storage
