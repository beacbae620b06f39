// The approved models of a satellite's equipment, in a simulator: the interface of client.h for
// C++17. All of it is inline, so that a program depends on the C ABI alone.
//
// client.h has the meaning of every option, event, flag and state. Here:
//
//   a C call that            | its C++ form
//   returns NULL or < 0      | throws ClientError with the text of reident_last_error
//   says that there is none  | returns an empty optional
//   returns flags            | returns them, throws nothing
//
// Threads: a Client is for one thread at a time and so is each Runner; several runners may run on
// several threads. The client works on a thread of its own. Times are nanoseconds since
// 1970-01-01T00:00:00 UTC, texts are UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <reident/client.h>

namespace reident {

/// A call could not do what it was asked to do: what() says why and what would mend it. Thrown for
/// REIDENT_BAD_ARGUMENT, REIDENT_UNAVAILABLE and REIDENT_FAILED alike.
class ClientError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a Client joins and subscribes to. By default: all of `operations`.
struct ClientOptions {
  std::string simulator;     // unique in the partition; empty: host and process id
  std::uint32_t domain = 0;  // DDS domain, 0 to 230
  std::string partition = "operations";
  std::string spacecraft = "*";        // name or pattern with * and ?
  std::vector<std::string> equipment;  // names or patterns; empty: every one
  /// Where the last good versions are kept; absent: the user's cache folder; empty: nowhere.
  std::optional<std::string> cache_folder;
  /// On a secured domain: folder of the simulator's certificate (deploy/SECURITY.md); absent: what
  /// REIDENT_SECURITY names, if anything; empty: not secured.
  std::optional<std::string> security_folder;
};

/// An input or output of a runner: the SATCS parameter (of an output: the model's output) and its
/// unit. An empty unit is not checked.
struct ClientSignal {
  std::string name;
  std::string unit;
};

/// What happened, as in reident_event; it owns its texts. What does not belong to its kind is 0 or
/// empty. Kinds that a later library adds have other values: ignore them.
struct ClientEvent {
  enum class Kind { available = 1, swapped, refused, offered, cache, fault, unpublished };
  Kind kind;
  std::string spacecraft, equipment;
  std::string text;  // one sentence for a log
  std::int64_t version;
  bool from_cache;  // kept from an earlier run, and not confirmed by a service in this one
  std::int64_t time_ns, decided_ns, published_ns;
  // After a swap: the largest difference at the last step, in the output's unit; the steps over
  // which it comes in; the steps that the new state was estimated from.
  double remaining_step;
  int transition_steps, matched_rows;
};

/// Where a run stands after its last step; see client.h.
using RunnerState = reident_runner_state;
/// A question about the history; reident_history_init sets its defaults.
using ClientHistoryQuery = reident_history_query;

namespace detail {

/// Returns `result`. Throws ClientError where it is a code below 0.
inline int checked(int result) {
  if (result < 0) throw ClientError(reident_last_error());
  return result;
}

/// Returns `result`. Throws ClientError where it is null.
template <class T>
T* checked(T* result) {
  if (result == nullptr) throw ClientError(reident_last_error());
  return result;
}

/// Ends a client or a runner that its owner lets go.
struct Close {
  void operator()(reident_client* client) const { reident_client_close(client); }
  void operator()(reident_runner* runner) const { reident_runner_close(runner); }
};

}  // namespace detail

class Client;

/// Runs the model of one equipment, step by step, and changes to a new version between two steps.
///
/// Shapes: u has one value for each of `inputs`, y and measured one for each of `outputs`, in the
/// order and units in which they were declared.
/// Requires: it ends before its client.
/// Threads: one at a time, which need not be the client's. step(), follow() and observe() allocate
/// nothing, take no lock and make no system call.
class Runner {
 public:
  /// Opens the run; its first step has the newest version, where there is one.
  /// Requires: at least one output, each name once, and no other runner of the equipment in this
  /// client. More inputs may be declared than a version needs; its outputs are those declared.
  /// Throws ClientError where a requirement is not met.
  /// Threads: the client's.
  Runner(Client& client, const std::string& spacecraft, const std::string& equipment,
         const std::vector<ClientSignal>& inputs, const std::vector<ClientSignal>& outputs);

  /// Runs one tick freely: `y` follows from the inputs alone.
  /// Requires: both arrays, which are not checked; one call each sample period.
  /// Returns the REIDENT_... flags; with REIDENT_NO_MODEL `y` is NaN. Throws nothing.
  int step(const double* u, double* y) noexcept { return reident_step(runner_.get(), u, y); }
  /// Runs one tick corrected by the measured outputs, NaN where one is missing. `y` is computed
  /// before they are used.
  /// Requires what step() does.
  /// Returns the flags; REIDENT_NOT_FOLLOWING where the run stayed free, since the version has no
  /// gain or an output is missing. Throws nothing.
  int follow(const double* u, const double* measured, double* y) noexcept {
    return reident_follow(runner_.get(), u, measured, y);
  }
  /// Gives a free run what was measured at its last step, NaN where one is missing: the running
  /// error counts it, and a swap estimates its state from it.
  /// Requires: an array, which is not checked. Does nothing before the first step on a version.
  /// Throws nothing.
  void observe(const double* measured) noexcept { reident_observe(runner_.get(), measured); }
  /// Takes the version that is offered, at the next step.
  /// Throws ClientError: none is offered, or the declaration does not cover its signals.
  /// Takes a lock, unlike the calls above.
  void accept() { detail::checked(reident_accept(runner_.get())); }
  /// Returns what a declared input, counted from 0, was at the last step: REIDENT_INPUT_MISSING,
  /// REIDENT_INPUT_OUTSIDE, both or 0. Throws ClientError beyond the last input.
  int input_flags(std::size_t input) const {
    return detail::checked(reident_input_flags(runner_.get(), input));
  }
  /// Returns where the run stands after its last step; version 0 where none runs yet.
  /// Throws ClientError where the machine fails. Takes a lock.
  RunnerState state() const {
    RunnerState state{};
    state.size = sizeof(state);
    detail::checked(reident_runner_get_state(runner_.get(), &state));
    return state;
  }

 private:
  std::unique_ptr<reident_runner, detail::Close> runner_;
};

/// Subscribes to approved versions: receives, verifies and keeps them, and acknowledges what runs.
///
/// Requires: it outlives its runners.
/// Threads: one at a time. It works on a thread of its own, which takes no signals.
class Client {
 public:
  /// Joins the partition; does not wait for a service. Versions that an earlier run kept are there
  /// when it returns.
  /// Requires: a domain from 0 to 230. The options are copied.
  /// Throws ClientError: wrong options, or the middleware failed.
  explicit Client(const ClientOptions& options);

  /// Waits at most `timeout_ms` milliseconds (-1: for ever) for the next event. At most 1024 are
  /// kept; beyond that the oldest are lost.
  /// Returns the event; absent where none came in time.
  /// Throws ClientError where the machine fails.
  /// Threads: the client's; blocks that thread alone.
  std::optional<ClientEvent> next_event(int timeout_ms = 0);

  /// Returns the newest verified version of an equipment as a JSON object with version, digest,
  /// decided_ns, decided_by, rollback and model (signals with units and ranges, matrices, scores).
  /// Absent where none has come. Throws no ClientError.
  std::optional<std::string> version_json(const std::string& spacecraft,
                                          const std::string& equipment) {
    const char* json = reident_version_json(client_.get(), spacecraft.c_str(), equipment.c_str());
    return json == nullptr ? std::nullopt : std::optional<std::string>(json);
  }

  /// Asks the running service for history and calls `row` with each row, a JSON object, on this
  /// thread, page after page until the last.
  /// Units: timeout_ms in milliseconds, for each page.
  /// Requires: a query from reident_history_init; a `row` that does not throw.
  /// Throws ClientError: the service refuses the question, or did not answer in time. Rows of the
  /// pages before were given then.
  /// Threads: the client's; blocks that thread alone.
  void history(const ClientHistoryQuery& query, const std::function<void(const char*)>& row,
               int timeout_ms = 10000);

  /// Returns the client of the C interface, such as for reident_on_event; never null. This object
  /// owns it.
  reident_client* handle() { return client_.get(); }

 private:
  std::unique_ptr<reident_client, detail::Close> client_;
};

// Implementation: plain structures out of the types, and nothing that outlives its call.

inline Client::Client(const ClientOptions& options) {
  std::vector<const char*> equipment;
  for (const std::string& name : options.equipment) equipment.push_back(name.c_str());
  reident_options c{};
  reident_options_init(&c);
  c.simulator = options.simulator.empty() ? nullptr : options.simulator.c_str();
  c.domain = options.domain;
  c.partition = options.partition.c_str();
  c.spacecraft = options.spacecraft.c_str();
  c.equipment = equipment.data();
  c.equipment_count = equipment.size();
  c.cache_folder = options.cache_folder ? options.cache_folder->c_str() : nullptr;
  c.security_folder = options.security_folder ? options.security_folder->c_str() : nullptr;
  client_.reset(detail::checked(reident_client_open(&c)));
}

inline std::optional<ClientEvent> Client::next_event(int timeout_ms) {
  reident_event event{};
  event.size = sizeof(event);
  if (detail::checked(reident_next_event(client_.get(), &event, timeout_ms)) == 0)
    return std::nullopt;
  return ClientEvent{static_cast<ClientEvent::Kind>(event.kind),
                     event.spacecraft,
                     event.equipment,
                     event.text,
                     event.version,
                     event.from_cache != 0,
                     event.time_ns,
                     event.decided_ns,
                     event.published_ns,
                     event.remaining_step,
                     event.transition_steps,
                     event.matched_rows};
}

inline void Client::history(const ClientHistoryQuery& query,
                            const std::function<void(const char*)>& row, int timeout_ms) {
  const auto call = [](const char* json, void* user) {
    (*static_cast<const std::function<void(const char*)>*>(user))(json);
  };
  std::vector<char> next(4096);  // a cursor takes at most a few hundred bytes
  std::string cursor;
  do {
    detail::checked(reident_history_page(client_.get(), &query, cursor.c_str(), timeout_ms, call,
                                         const_cast<void*>(static_cast<const void*>(&row)),
                                         next.data(), next.size()));
    cursor = next.data();
  } while (!cursor.empty());
}

inline Runner::Runner(Client& client, const std::string& spacecraft, const std::string& equipment,
                      const std::vector<ClientSignal>& inputs,
                      const std::vector<ClientSignal>& outputs) {
  const auto c_signals = [](const std::vector<ClientSignal>& signals) {
    std::vector<reident_signal> result;
    for (const ClientSignal& signal : signals)
      result.push_back({signal.name.c_str(), signal.unit.empty() ? nullptr : signal.unit.c_str()});
    return result;
  };
  const auto c_inputs = c_signals(inputs), c_outputs = c_signals(outputs);
  runner_.reset(detail::checked(
      reident_runner_open(client.handle(), spacecraft.c_str(), equipment.c_str(), c_inputs.data(),
                          c_inputs.size(), c_outputs.data(), c_outputs.size())));
}

}  // namespace reident
