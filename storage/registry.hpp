// Attempts, versions and decisions: what was tried, what came out, what was decided and why.
//
// Rows are only ever added. Every attempt at a window is recorded. An attempt that gave a model has
// a version; its number counts the versions of one equipment from 1. Every version has at least one
// decision. The champion of an equipment at a time is the version named by the last decision of
// kind `approve` or `roll_back` not later than it; the last one is the one with the highest id,
// which also holds when the clock was set back.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/database.hpp"
#include "storage/telemetry.hpp"

namespace reident::storage {

struct NewAttempt {
  std::string spacecraft;
  std::string equipment;
  TimeRange window;
  std::string trigger;  // why now: "slide", "late telemetry", ...
  Time time = 0;        // when it was decided
  std::string outcome;  // "approved", "waiting", or the code of the reason that speaks against it
  std::string reason;   // one sentence for an operator
  std::string evidence_json;  // scores, coverage, timings: all that the decision looked at
  std::string configuration_digest;
  std::string program_version;
};

struct NewVersion {
  std::string model_json;  // complete and exact: the version can be rebuilt from it alone
  std::string digest;      // SHA-256 of the model, hexadecimal
};

enum class DecisionKind { approve, reject, wait, roll_back };
std::string_view name(DecisionKind kind);

struct NewDecision {
  DecisionKind kind = DecisionKind::reject;
  std::string actor;  // "gate" or an operator's name
  std::string reason;
};

struct Attempt : NewAttempt {
  std::int64_t id = 0;
  std::optional<std::int64_t> version;
};

struct Version {
  std::string spacecraft;
  std::string equipment;
  std::int64_t number = 0;
  std::int64_t attempt = 0;
  TimeRange window;
  Time created = 0;
  std::string model_json;
  std::string digest;
  std::string status;  // "approved" (champion now), "superseded", "rejected", "waiting"
};

struct Decision : NewDecision {
  std::int64_t id = 0;
  std::string spacecraft;
  std::string equipment;
  std::int64_t version = 0;
  Time time = 0;
};

/// Empty fields select everything.
struct HistoryFilter {
  std::string spacecraft;
  std::string equipment;
  std::optional<TimeRange> window;  // attempts whose window overlaps it
  bool versions_only = false;       // leave out attempts that gave no model
  std::optional<std::size_t> last;  // the newest so many
};

class Registry {
 public:
  /// The database must outlive the registry.
  explicit Registry(Database& database);

  /// An attempt that gave no model. Returns its id.
  std::int64_t record(const NewAttempt& attempt);
  /// An attempt, the next version of its equipment and the decision about it, in one transaction.
  /// Returns the version's number.
  std::int64_t record(const NewAttempt& attempt, const NewVersion& version,
                      const NewDecision& decision);
  /// One more decision about a version that exists. Returns the decision's id.
  std::int64_t decide(const std::string& spacecraft, const std::string& equipment,
                      std::int64_t version, const NewDecision& decision, Time time);

  std::optional<Version> version(const std::string& spacecraft, const std::string& equipment,
                                 std::int64_t number) const;
  /// The champion now, or at `time`.
  std::optional<Version> champion(const std::string& spacecraft, const std::string& equipment,
                                  std::optional<Time> time = std::nullopt) const;
  std::vector<Version> champions() const;
  /// Ascending by id.
  std::vector<Decision> decisions(const std::string& spacecraft, const std::string& equipment,
                                  std::optional<std::int64_t> version = std::nullopt) const;
  /// Ascending by id.
  std::vector<Attempt> attempts(const HistoryFilter& filter = {}) const;
  /// End of the latest window that was tried for an equipment.
  std::optional<Time> last_window_end(const std::string& spacecraft,
                                      const std::string& equipment) const;

 private:
  Database& database_;
};

}  // namespace reident::storage
