// Where a version comes from: all that is needed to identify it again from the archive, and the
// digests that show whether it came out the same.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "service/windows/candidate.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// Returns the version of a window that gave a candidate: model, parts, options and digests.
/// Requires a candidate.
storage::NewVersion version_of(const RefreshRequest& request, const PreparedWindow& prepared);

/// SHA-256, hexadecimal, of the samples on the grid, all parts of the window: for each segment its
/// first tick, its number of rows and the inputs and outputs row by row, as little-endian 64-bit
/// integers and doubles, after the names of inputs and outputs, each ended by a line feed.
std::string digest_of_samples(const identification::Record& record, const WindowRequest& request);

/// Returns the relations that its window was checked with; none where its provenance does not say
/// or cannot be read.
std::vector<Relation> relations_of(const storage::Version& version);

/// What came of identifying a version again.
struct Reproduction {
  std::string samples_digest;   // of the samples that it was identified from this time
  std::string model_digest;     // empty where the window gives no model
  std::string reason;           // why it gives none
  std::string program_version;  // that made the version
  bool same_samples = false;
  std::size_t revisions = 0;  // changes of the window's telemetry since, that were taken back
  bool same_model = false;    // to the last bit
};

/// Returns what is wrong with what the registry keeps of a version, by itself: its model is not
/// that of its digest or of its equipment, or its provenance says something else than its row.
/// Absent where nothing is. Throws nothing for what is kept.
std::optional<std::string> mistake_in(const storage::Version& version);

/// Identifies a version again, from the telemetry as it was then: what came late since is taken
/// back until the samples have the digest that the version names. One that an earlier version was
/// adapted to is adapted from that again. Throws std::invalid_argument where its provenance or that
/// version cannot be read, and storage::Error where telemetry cannot. Takes as long as a refresh,
/// and for each change that is taken back as long as loading a window.
Reproduction reproduce(const storage::Archive& archive, const storage::Registry& registry,
                       const storage::Version& version, const identification::ForEach& for_each);

}  // namespace reident
