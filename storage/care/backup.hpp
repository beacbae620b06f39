// A copy of the database file, made while the file is written.
//
// The copy holds one snapshot: every transaction that was committed when it began, and nothing of
// later ones, however long it takes. Writers and readers go on meanwhile; the log of the source
// grows by what is written until the copy is complete.
//
// It is written to "<copy>.partial", forced to the disk, looked at, and then takes its name in one
// step: a file of that name is always whole. What a killed backup leaves is "<copy>.partial", which
// the next one replaces.
//
// Shards of the source are copied into "<copy>.shards" before that. They never change, so that one
// which is there already is not copied again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>

#include "storage/database/database.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// How a copy is made.
struct BackupOptions {
  bool replace = false;  // an existing copy, in the moment in which the new one is whole
  std::uint32_t pages_of_step = 2048;  // copied between two reports of progress
};

/// How far it is, in pages of the file.
struct BackupProgress {
  std::uint64_t pages = 0;  // of the snapshot
  std::uint64_t done = 0;
};

/// What the copy holds.
struct BackupReport {
  std::filesystem::path copy{};
  std::uint64_t bytes = 0;        // of the copy itself
  std::uint64_t shards = 0;       // that it refers to, in "<copy>.shards"
  std::uint64_t shard_bytes = 0;  // of those that were not there yet
  std::uint64_t samples = 0;
  std::uint64_t versions = 0;
  std::optional<Time> newest{};  // generation time of the newest sample
};

/// Copies `source`, which may be opened for reading alone. `go_on` is asked after each step.
/// Returns what the copy holds; absent where `go_on` said no, and then no copy is left. Throws
/// Error, and leaves no copy: cannot_open (the copy exists, is the source or one of its companions,
/// its folder does not exist), locked (a service or another backup writes the copy), read_only,
/// full, corrupt (the source is damaged).
std::optional<BackupReport> back_up(Database& source, const std::filesystem::path& copy,
                                    const BackupOptions& options,
                                    const std::function<bool(const BackupProgress&)>& go_on);

}  // namespace reident::storage
