// Whether a database file holds what it says: every checksum and every invariant of SCHEMA.md.
//
// Works beside a writer. Each table and each series is read in a snapshot of its own, so that the
// log is not kept from being folded into the file for longer than one of them takes; SQLite's own
// check of all pages is one snapshot.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "storage/registry/registry.hpp"

namespace reident::storage {

/// Something that is not as it should be.
struct Finding {
  std::string check;         // what was looked at: "pages", "schema", "chunk", "series", ...
  std::string spacecraft{};  // empty where it concerns the file as a whole
  std::string name{};        // of the parameter, source or equipment
  std::optional<Origin> origin{};
  std::optional<Time> first{}, last{};  // generation times that it concerns, both included
  std::string what;                     // a sentence without its full stop
  std::string remedy;                   // what an operator can do
};

struct VerifyOptions {
  /// Looks at the summaries of chunks and does not decode them; leaves out what follows from their
  /// samples, and that indexes agree with their tables.
  bool quick = false;
  /// What is wrong with a version's model or provenance; storage cannot read them.
  std::function<std::optional<std::string>(const Version&)> mistake_in{};
};

struct VerifyProgress {
  double share = 0;  // of the work, from 0 to 1
  std::string at;    // what is looked at
};

struct VerifyReport {
  std::vector<Finding> findings;  // the first `most_findings` of them
  std::uint64_t found = 0;        // all
  std::uint64_t series = 0;       // looked at
  std::uint64_t chunks = 0;
  std::uint64_t samples = 0;  // in chunks and recent runs
  std::uint64_t versions = 0;
  bool complete = true;  // false when it was stopped

  static constexpr std::size_t most_findings = 1000;
  void add(Finding finding);
};

/// Damage does not throw: it is what is looked for. `go_on` is asked often; where it says no, what
/// was found until then is returned.
VerifyReport verify(Database& database, const VerifyOptions& options,
                    const std::function<bool(const VerifyProgress&)>& go_on);

}  // namespace reident::storage
