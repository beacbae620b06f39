// The approved models of a satellite's equipment, in a simulator: the interface of client.h, which
// has the details, for C++17. All of it is inline, so that a program depends on the C ABI alone.
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

/// A call could not do what it was asked to; says why and what would mend it.
class ClientError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ClientOptions {
  std::string simulator;     // unique in the partition; empty: host and process id
  std::uint32_t domain = 0;  // DDS domain
  std::string partition = "operations";
  std::string spacecraft = "*";        // name or pattern with * and ?
  std::vector<std::string> equipment;  // names or patterns; empty: every one
  /// Where the last good versions are kept; absent: the user's cache folder; empty: nowhere.
  std::optional<std::string> cache_folder;
};

/// An input or output by its name. An empty unit is not checked.
struct ClientSignal {
  std::string name;
  std::string unit;
};

struct ClientEvent {
  enum class Kind { available = 1, swapped, refused, offered, cache, fault };
  Kind kind;
  std::string spacecraft, equipment;
  std::string text;  // one sentence for a log
  std::int64_t version;
  bool from_cache;
  std::int64_t time_ns, decided_ns, published_ns;
  double remaining_step;
  int transition_steps, matched_rows;
};

using RunnerState = reident_runner_state;
using ClientHistoryQuery = reident_history_query;

namespace detail {

inline int checked(int result) {
  if (result < 0) throw ClientError(reident_last_error());
  return result;
}

template <class T>
T* checked(T* result) {
  if (result == nullptr) throw ClientError(reident_last_error());
  return result;
}

struct Close {
  void operator()(reident_client* client) const { reident_client_close(client); }
  void operator()(reident_runner* runner) const { reident_runner_close(runner); }
};

}  // namespace detail

class Client;

/// Runs the model of one equipment; see client.h. For one thread at a time; ends before its client.
class Runner {
 public:
  Runner(Client& client, const std::string& spacecraft, const std::string& equipment,
         const std::vector<ClientSignal>& inputs, const std::vector<ClientSignal>& outputs);

  /// Both return REIDENT_... flags and fill `y` in.
  int step(const double* u, double* y) noexcept { return reident_step(runner_.get(), u, y); }
  int follow(const double* u, const double* measured, double* y) noexcept {
    return reident_follow(runner_.get(), u, measured, y);
  }
  void observe(const double* measured) noexcept { reident_observe(runner_.get(), measured); }
  /// Takes the version that is offered. Throws ClientError.
  void accept() { detail::checked(reident_accept(runner_.get())); }
  int input_flags(std::size_t input) const {
    return detail::checked(reident_input_flags(runner_.get(), input));
  }
  RunnerState state() const {
    RunnerState state{};
    state.size = sizeof(state);
    detail::checked(reident_runner_get_state(runner_.get(), &state));
    return state;
  }

 private:
  std::unique_ptr<reident_runner, detail::Close> runner_;
};

/// Subscribes; see client.h.
class Client {
 public:
  explicit Client(const ClientOptions& options);

  /// The next event, waiting for it at most `timeout_ms` (-1: for ever).
  std::optional<ClientEvent> next_event(int timeout_ms = 0);

  /// The newest verified version of an equipment as JSON.
  std::optional<std::string> version_json(const std::string& spacecraft,
                                          const std::string& equipment) {
    const char* json = reident_version_json(client_.get(), spacecraft.c_str(), equipment.c_str());
    return json == nullptr ? std::nullopt : std::optional<std::string>(json);
  }

  /// Calls `row` with each row (JSON) of the history, page by page. Throws ClientError.
  void history(const ClientHistoryQuery& query, const std::function<void(const char*)>& row,
               int timeout_ms = 10000);

  reident_client* handle() { return client_.get(); }

 private:
  std::unique_ptr<reident_client, detail::Close> client_;
};

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
  std::vector<char> next(4096);
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
