// Rows of the registry: attempts, versions, decisions, commands, and how they are selected.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "storage/types/telemetry.hpp"

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
  // What it was identified from, so that it can be identified again; empty in versions from before
  // schema 2.
  std::string provenance_json{};  // window, parts, options
  std::string samples_digest{};   // SHA-256 of the samples, hexadecimal
};

enum class DecisionKind { approve, reject, wait, roll_back, withdraw };
std::string_view name(DecisionKind kind);
/// Absent where no kind has that name.
std::optional<DecisionKind> decision_kind(std::string_view name);

struct NewDecision {
  DecisionKind kind = DecisionKind::reject;
  std::string actor;  // "gate" or an operator's name
  std::string reason;
  std::string evidence_json{};  // what it looked at beside the attempt; empty: nothing
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
  // "approved" (champion now), "superseded", "rejected", "waiting", "withdrawn" (for ever)
  std::string status;
  std::optional<std::int64_t> parent;  // absent where it was judged against no champion
  std::string provenance_json;
  std::string samples_digest;
};

/// A version without its model.
struct VersionSummary {
  std::int64_t number = 0;
  std::string status;
  std::optional<std::int64_t> parent;
};

struct Decision : NewDecision {
  std::int64_t id = 0;
  std::string spacecraft;
  std::string equipment;
  std::int64_t version = 0;
  Time time = 0;
};

/// An operator's word that the champion of an equipment stays, until it is released.
struct Hold {
  std::string actor;
  std::string reason;
  Time since = 0;
};

/// What a decision about an equipment stands on: it changes with every decision and hold.
struct Standing {
  std::int64_t last_decision = 0;  // id, 0 before the first
  std::int64_t last_hold = 0;
  bool operator==(const Standing&) const = default;
};

/// An operator's command, identified by who asks and that one's count.
struct Command {
  std::string requester;  // unique name of the asking program
  std::uint64_t request = 0;
  std::string action;
  std::string spacecraft;
  std::string equipment;
  std::int64_t version = 0;  // 0 where the action names none
  std::string actor;         // the operator's name
  std::string reason;
  bool operator==(const Command&) const = default;
};

struct CommandOutcome {
  bool ok = false;
  std::string reply;  // what was done, or why not
};

struct EquipmentName {
  std::string spacecraft;
  std::string equipment;
  auto operator<=>(const EquipmentName&) const = default;
};

/// Empty fields select everything.
struct HistoryFilter {
  std::string spacecraft;
  std::string equipment;
  std::optional<TimeRange> window;  // attempts whose window overlaps it
  bool versions_only = false;       // leave out attempts that gave no model
  std::optional<std::size_t> last;  // the newest so many
};

/// Which rows are read one after the other, by whoever may not hold all of them. Empty fields
/// select everything.
struct RowFilter {
  std::string spacecraft;
  std::string equipment;
  std::optional<TimeRange>
      range;  // attempts and versions whose window overlaps it, decisions in it
  std::optional<std::int64_t> version;
  bool newest_first = false;
  std::optional<std::int64_t> beyond;  // only rows after this id, in the order that is asked for
};

}  // namespace reident::storage
