// Whether a database file holds what it says: every checksum and every invariant of SCHEMA.md.
//
// It works while the file is written. Each table and each series is read in a snapshot of its own,
// so that the log is not kept from being folded into the file for longer than one of them takes.
// SQLite's own check of all pages is one snapshot. SCHEMA.md, "Verify", lists the checks and what
// they cannot find.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "storage/registry/registry.hpp"

namespace reident::storage {

/// Something that is not as it should be. One damage may give several findings, since each check
/// reports what it sees.
struct Finding {
  /// What was looked at: "pages", "schema", "chunk", "series", ...
  std::string check;
  std::string spacecraft{};  // empty where it concerns the file as a whole
  std::string name{};        // of the parameter, source or equipment
  std::optional<Origin> origin{};
  /// Generation times that it concerns, both included.
  std::optional<Time> first{}, last{};
  std::string what;    // a sentence without its full stop
  std::string remedy;  // what an operator can do
};

/// Chunks in which nothing was found: XXH64 of their bytes, by the row of chunk_data and the shard.
using SoundChunks = std::unordered_map<std::int64_t, std::uint64_t>;

/// How thoroughly to look.
struct VerifyOptions {
  /// Looks at the summaries of chunks and does not decode them; leaves out what follows from their
  /// samples, and that indexes agree with their tables.
  bool quick = false;
  /// Chunks that an earlier verify found sound are not decoded where their bytes are the same.
  /// Leaves out the comparison of gaps for their series: it takes the samples of all.
  const SoundChunks* known = nullptr;
  /// Returns what is wrong with a version's model or provenance, in words; absent where nothing is.
  /// Storage cannot read them: without this function they are not checked.
  std::function<std::optional<std::string>(const Version&)> mistake_in{};
};

/// How far it is; shares are of the work, which chunks take most of.
struct VerifyProgress {
  double share = 0;  // of the work, from 0 to 1
  std::string at;    // what is looked at
};

/// What was found and how much was looked at. Every check passed where it is complete and found
/// nothing.
struct VerifyReport {
  std::vector<Finding> findings;  // the first `most_findings` of them
  std::uint64_t found = 0;        // all
  std::uint64_t series = 0;       // looked at
  std::uint64_t chunks = 0;
  std::uint64_t samples = 0;  // in chunks and fragments
  std::uint64_t versions = 0;
  bool complete = true;     // false when it was stopped
  std::uint64_t known = 0;  // chunks that were not decoded since they are as they were
  SoundChunks sound;        // those and what was decoded; none where it looked quickly
  std::set<std::int64_t> unreadable_shards{};  // whose chunks were not looked at

  static constexpr std::size_t most_findings = 1000;
  /// Counts a finding, and keeps it where fewer than most_findings are kept.
  void add(Finding finding);
};

/// Checks the file of `database`, which may be opened for reading alone. `go_on` is asked often.
/// Returns what was found; where `go_on` said no, what was found until then, not complete. Damage
/// is reported and does not throw.
VerifyReport verify(Database& database, const VerifyOptions& options,
                    const std::function<bool(const VerifyProgress&)>& go_on);

}  // namespace reident::storage
