// What the service says on its topics besides telemetry and models; idl/README.md has the table.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "storage/registry.hpp"
#include "storage/telemetry.hpp"

namespace reident {

/// One attempt at a window: the outcome and why, rejected ones included.
struct IdentificationReport {
  std::string spacecraft;
  std::string equipment;
  std::int64_t attempt = 0;
  storage::TimeRange window;
  std::string trigger;
  std::string outcome;       // "approved", "waiting" or a reason code
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

/// Which version a simulator runs, and the newest that it refused, if it did since.
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
};

struct CommandReply {
  std::string requester;
  std::uint64_t request = 0;
  storage::CommandOutcome outcome;
};

/// Heartbeat of a service.
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
  std::string last_error;  // empty when all is well
};

}  // namespace reident
