// A CSV file into the archive: read as a stream, stored in batches, each with the place in the file
// up to which it goes in one transaction. An import that was stopped or killed goes on there.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "service/transfer/import_rows.hpp"
#include "storage/archive/import_log.hpp"

namespace reident::transfer {

/// Bounds of one batch, and so of the memory. With twice as many samples an import takes more of
/// the processor, for new pages; with half as many too, for commits.
struct ImportLimits {
  std::uint64_t samples = 131072;
  std::size_t frames = 65536;
};

/// How far it is, after a batch that is in the archive.
struct ImportProgress {
  double fraction = 0;            // of the file's bytes
  std::uint64_t samples = 0;      // of this run
  storage::ImportPosition total;  // of all runs
};

/// What came of it.
struct ImportReport {
  storage::ImportPosition total;  // of all runs, from the file's first row
  std::uint64_t samples = 0;      // of this run
  std::uint64_t new_parameters = 0;
  std::uint64_t resumed_at = 0;              // line; 0 where it started at the first row
  bool complete = false;                     // false: stopped before the end
  telemetry_file::LeftOut left_out;          // rows of this run
  std::vector<std::string> first_bad_lines;  // at most 5 messages
  std::string found;                         // how the file is read
  std::string postponed;                     // the shard that samples wait for, and the remedy
  std::vector<std::string> remarks;          // what else a user has to know, one sentence each
};

/// Called after each batch; false stops the import there.
using ImportObserver = std::function<bool(const ImportProgress&)>;

/// Imports `file`, which is options.file as it was opened with options.reading, or goes on with an
/// import of it that did not end: same options, same columns, same bytes so far. Requires a
/// database that is open for writing, and a regular file that does not change meanwhile. `now`
/// gives the times of the log. An error where the file, the options or a row is wrong; rows before
/// it are in the archive, and the same call goes on there when the line is mended. Throws
/// storage::Error when the archive cannot be written; then the same call goes on too.
std::variant<ImportReport, csv::Error> import_file(storage::Database& database,
                                                   telemetry_file::TelemetryFile& file,
                                                   const ImportOptions& options,
                                                   const std::function<storage::Time()>& now,
                                                   const ImportObserver& observer,
                                                   const ImportLimits& limits = {});

}  // namespace reident::transfer
