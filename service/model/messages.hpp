// What the service says on its topics besides telemetry and models; idl/README.md has the table.
//
// These types know no DDS: the codec (service/dds/codec.hpp) copies them, and checks names, sizes
// and constants on the way in. Times are nanoseconds since 1970 UTC. A member that an older program
// does not send has its default here.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "storage/types/journal.hpp"
#include "storage/types/registry_rows.hpp"
#include "storage/types/telemetry.hpp"

namespace reident {

/// One attempt at a window: the outcome and why, rejected ones included.
struct IdentificationReport {
  std::string spacecraft;
  std::string equipment;
  std::int64_t attempt = 0;
  storage::TimeRange window;
  std::string trigger;
  std::string outcome;       // "challenger" or a reason code
  std::string reason;        // one sentence
  std::int64_t version = 0;  // 0 where there is none
  int order = 0;             // 0 where there is no model
  double mrse_percent = 0;   // NaN where there is no model
  double fit_percent = 0;
  double champion_mrse_percent = 0;  // on the same samples; NaN where there was none
  storage::Time time = 0;
};

/// What a simulator does with the model of one equipment.
struct RunningModel {
  std::int64_t version = 0;          // 0: none runs
  std::int64_t offered_version = 0;  // has other signals and waits to be taken; 0: none
  std::string mode;                  // "free", "following"; empty: nothing runs, or not known
  bool from_cache = false;           // no service has confirmed the version in this run
  storage::Time decided = 0;         // when the version was approved
  storage::Time since = 0;           // its first step, by the simulator's clock
  double mrse_percent = std::numeric_limits<double>::quiet_NaN();  // since then; NaN: no sample yet
  double remaining_step = 0;  // of the last swap, in the output's unit, largest of the outputs
  std::int32_t transition_steps = 0;  // over which it comes in
  std::uint64_t steps = 0;            // since the swap
  std::uint64_t steps_outside = 0;    // with an input outside the identified range
  std::uint64_t steps_missing = 0;    // with an input missing
  bool operator==(const RunningModel&) const = default;
};

/// Which version a simulator runs, and the newest that it refused, if it did since. One for each
/// simulator and equipment; it lives as long as the simulator does.
struct ModelAcknowledgement {
  std::string simulator;
  std::string spacecraft;
  std::string equipment;
  std::int64_t version = 0;  // running.version, or the one that was refused
  std::string digest;        // of `version`
  bool accepted = true;      // false: refused, `reason` says why, and running.version goes on
  std::string reason;
  RunningModel running;
  std::string host;
  std::uint64_t process = 0;
  std::string program_version;  // empty: of a time before there was a `running`
};

/// An operator's order, sent again until its reply comes.
struct CommandRequest {
  storage::Command command;
  std::string service;  // instance name of the one that is asked; empty: every one
  // service/security/command_signature.hpp; both empty on a domain that is not secured.
  std::string certificate{};  // of who signed, PEM
  std::string signature{};    // hexadecimal
};

/// What came of a command; kept with the command, so that each copy of it gets the first reply.
struct CommandReply {
  std::string requester;  // with `request`: which command it answers
  std::uint64_t request = 0;
  storage::CommandOutcome outcome;
};

/// A question to the archive and the registry; idl/README.md, "History", says what each field
/// selects for which subject.
struct HistoryQuery {
  std::string subject;
  std::string spacecraft;  // empty selects every one
  std::string equipment;
  storage::TimeRange range;  // empty selects all of time
  std::int64_t version = 0;  // 0 selects every one
  std::uint32_t page_size = 1000;
  std::string cursor;  // empty for the first page
  bool newest_first = false;
  storage::Origin origin = storage::Origin::real;
  std::uint32_t parameter = 0;  // id, where the subject is samples or completeness
  storage::Time step = 0;       // of completeness: a bin's length
  storage::Time until = 0;      // of completeness: how far the spacecraft's telemetry reaches
};

/// Rows are JSON objects; the cursor is empty on the last page.
struct HistoryPage {
  std::vector<std::string> rows;
  std::string next_cursor;
};

/// A question on its way, sent again until its reply comes; asking twice changes nothing.
struct HistoryRequest {
  std::uint16_t slot = 0;  // the key; a program keeps the one that it chose
  std::string requester;   // unique name of the asking program
  std::uint64_t request = 0;
  std::string service;  // instance name of the one that is asked; empty: every one
  HistoryQuery query;
};

/// One page on its way back. The next page has to be asked of `service`, whose cursor it is.
struct HistoryReply {
  std::uint16_t slot = 0;
  std::string requester;
  std::uint64_t request = 0;
  std::string service;  // instance name of the one that answers
  bool ok = false;
  std::string reason;  // where it is not ok: what is wrong and what would mend it
  HistoryPage page;
};

/// Heartbeat of a service, once a second. Counts are of this run of the service, but those of
/// missing sequence numbers, which are counted since the archive was made.
struct ServiceStatus {
  std::string service;  // instance name
  std::string program_version;
  storage::Time started = 0;
  storage::Time time = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_rejected = 0;  // malformed or too large
  std::uint64_t samples_stored = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t conflicts = 0;
  std::uint64_t late = 0;
  std::uint64_t sequence_missing = 0;
  std::uint64_t clock_jumps = 0;
  std::uint64_t queue_length = 0;     // frames taken and not yet committed
  std::uint64_t queue_waits = 0;      // times that the reader waited for room
  std::uint64_t windows_pending = 0;  // due or running
  std::uint64_t attempts = 0;
  std::uint64_t approvals = 0;
  storage::Time newest_telemetry = 0;
  std::string last_error;         // empty when all is well
  std::string failing_champions;  // equipment, separated by commas
  std::string alarms;             // one a line: "code SPACECRAFT/EQUIPMENT: text"
  std::string equipment;          // that it keeps true, separated by commas
  std::string pair;               // that it is of; empty: of none, and what follows says nothing
  std::string role;               // "leads", "follows" or "listens" (to who is there)
  std::int64_t term = 0;          // the last that it knows
  std::string partner;            // instance name of the other one, while it is heard
  std::int64_t lag = 0;           // rows of the registry that one of the two lacks; -1: not known
  std::uint64_t descriptors_rejected = 0;
  storage::Time certificate_end = 0;  // of the service's own; 0: the domain is not secured
};

/// Who leads a pair of services, said many times a second by whoever does.
struct Leadership {
  std::string pair;
  std::int64_t term = 0;
  std::string service;        // instance name
  std::int64_t position = 0;  // of the last row of its journal
  std::string successor;      // to whom it gives leadership; empty: it keeps it
};

/// What the services of a pair send each other about rows of the registry; idl/reident.idl says
/// which fields count for which kind.
struct Replica {
  enum class Kind : std::uint8_t { position, rows, terms, given_up, kept };
  std::string sender;
  std::string pair;
  std::string receiver;  // empty: the other one, whoever that is
  Kind kind = Kind::position;
  std::vector<storage::Term> terms;
  storage::JournalPart part;
};

/// Returns the counts with the names that people and programs see.
inline std::vector<std::pair<const char*, std::uint64_t>> counts(const ServiceStatus& status) {
  return {{"frames_received", status.frames_received},
          {"frames_rejected", status.frames_rejected},
          {"descriptors_rejected", status.descriptors_rejected},
          {"samples_stored", status.samples_stored},
          {"duplicates", status.duplicates},
          {"conflicts", status.conflicts},
          {"late", status.late},
          {"sequence_missing", status.sequence_missing},
          {"clock_jumps", status.clock_jumps},
          {"queue_length", status.queue_length},
          {"queue_waits", status.queue_waits},
          {"windows_pending", status.windows_pending},
          {"attempts", status.attempts},
          {"approvals", status.approvals}};
}

}  // namespace reident
