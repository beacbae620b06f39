// Which files were imported, and how far: kept with the samples, in their transactions.
//
// An import that was killed goes on where its last transaction ended. Nothing is lost by starting
// anew instead: samples that are there already are counted as duplicates.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "storage/archive/archive.hpp"

namespace reident::storage {

/// How far an import is. Samples are counted once each: stored + duplicates + conflicts.
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

class ImportLog {
 public:
  /// The database must outlive the log.
  explicit ImportLog(Database& database);

  /// Imports of the same request (what was asked for, in the importer's words) that did not come to
  /// their end, the last one first.
  struct Unfinished {
    std::int64_t id = 0;
    ImportPosition at;
  };
  std::vector<Unfinished> unfinished(const std::string& request) const;

  /// A new import of `file`; its id.
  std::int64_t begin(const std::string& file, const std::string& request, Time now);
  /// One transaction: describes the parameters, appends the frames, and adds what became of their
  /// samples to the counts of `at`, which is kept.
  AppendReport append(std::int64_t import, std::span<const ParameterDescriptor> descriptors,
                      std::span<const TelemetryFrame> frames, ImportPosition& at);
  void finish(std::int64_t import, Time now);

 private:
  Database& database_;
};

}  // namespace reident::storage
