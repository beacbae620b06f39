// What libreident-client does for a simulator: it subscribes, verifies, hands versions to the runs
// and reports to the service what runs, on a thread of its own. The C interface (c_interface.cpp)
// adds nothing but the translation.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "service/client/equipment_runner.hpp"
#include "service/client/model_subscriber.hpp"
#include "service/dds/dds.hpp"
#include "service/support/mutex.hpp"

namespace reident {

/// The name of a simulator that was given none: host and process id.
std::string default_simulator_name();

/// Where to take part, what to subscribe to, and where versions are kept.
struct SimulatorClientOptions {
  dds::Endpoint endpoint;
  Subscription subscription;
  std::optional<std::filesystem::path> cache;  // folder of the last good versions; absent: none
};

/// The meanings are those of reident_event in client.h.
struct SimulatorEvent {
  enum class Kind { available = 1, swapped, refused, offered, cache, fault, unpublished };
  Kind kind = Kind::available;
  storage::EquipmentName equipment;
  std::string text;
  std::int64_t version = 0;
  bool from_cache = false;
  storage::Time time = 0, decided = 0, published = 0;
  double remaining_step = 0;
  int transition_steps = 0;
  identification::Index matched_rows = 0;
};

/// Any thread may call it; runs are stepped on the simulator's threads without its lock. Its own
/// thread takes no signal. What the middleware throws there becomes an event of kind `fault`, and
/// the thread goes on.
class SimulatorClient {
 public:
  using Callback = std::function<void(const SimulatorEvent&)>;

  /// Events that are kept; the oldest go first.
  static constexpr std::size_t most_events = 1024;

  /// Joins the domain and starts the thread. Versions that were kept are there when it returns.
  /// Throws dds::Error.
  explicit SimulatorClient(const SimulatorClientOptions& options);
  /// Runs must not be stepped any more. Not from the callback.
  ~SimulatorClient();

  /// Begins a run of an equipment, which ends with the client or by close(). A sentence where no
  /// output is declared, a signal is declared twice or the equipment has a run here already. A
  /// version that is known already is posted or offered to the run before it returns.
  std::variant<EquipmentRunner*, std::string> open(const storage::EquipmentName& equipment,
                                                   Declaration declaration);
  /// Ends a run of open(), which must not be stepped any more. The service hears that nothing runs.
  void close(EquipmentRunner& runner);
  /// Has the run take the version that is offered. A sentence why it cannot.
  std::optional<std::string> accept(EquipmentRunner& runner);

  /// How a run stands to what is published.
  struct VersionState {
    std::int64_t offered = 0;  // 0: none
    bool from_cache = false;   // the version that runs or was posted
  };
  VersionState version_state(const EquipmentRunner& runner);

  /// Returns the oldest event that was not asked for yet, and waits for one at most `timeout`
  /// (negative: for ever). Absent where none came.
  std::optional<SimulatorEvent> next_event(std::chrono::milliseconds timeout);
  /// Events go to `callback`, on the client's thread, instead of being kept; null ends that. The
  /// one before is not called any more when it returns, so not from within a callback. A callback
  /// must neither block nor throw.
  void on_event(Callback callback);

  /// For questions about the history; lives as long as the client.
  dds::Participant& participant() { return participant_; }

  /// The newest verified version of an equipment; absent where none came.
  std::optional<ModelVersion> newest(const storage::EquipmentName& equipment);

 private:
  struct Run {
    std::unique_ptr<EquipmentRunner> runner;
    std::optional<ModelSubscriber::Verified> posted;  // runs, or will at the next step
    std::optional<ModelSubscriber::Verified> offered;
    RunningModel told;
    /// When to say that nobody publishes the equipment; absent once that was said.
    std::optional<std::chrono::steady_clock::time_point> say_unpublished;
  };
  void work();  // the thread
  /// Takes what was published, what the runs have left, and reports every few seconds.
  void look();
  void tell_fault(const char* what);
  void tell_unpublished() REIDENT_REQUIRES(mutex_);
  ModelSubscriber::Listener listener() REIDENT_REQUIRES(mutex_);
  /// Posts the version to the run where it fits what runs, and else offers it.
  void take_in(Run& run, const ModelSubscriber::Verified& verified) REIDENT_REQUIRES(mutex_);
  void offer(Run& run, const ModelSubscriber::Verified& verified, const std::string& reason)
      REIDENT_REQUIRES(mutex_);
  void post(Run& run, std::unique_ptr<PreparedModel> model,
            const ModelSubscriber::Verified& verified) REIDENT_REQUIRES(mutex_);
  void collect(Run& run) REIDENT_REQUIRES(mutex_);
  void acknowledge(Run& run, const RunState& state) REIDENT_REQUIRES(mutex_);
  void say(SimulatorEvent event) REIDENT_REQUIRES(mutex_);
  /// Hands kept events to the callback, without the lock.
  void deliver();
  /// How long the thread may wait: less while a run has yet to take what was posted.
  std::chrono::nanoseconds patience();
  Run* find(const storage::EquipmentName& equipment) REIDENT_REQUIRES(mutex_);

  dds::Participant participant_;
  dds::WaitSet ready_;
  Mutex mutex_;
  ModelSubscriber models_ REIDENT_GUARDED_BY(mutex_);
  std::vector<Run> runs_ REIDENT_GUARDED_BY(mutex_);
  std::deque<SimulatorEvent> events_ REIDENT_GUARDED_BY(mutex_);
  std::chrono::nanoseconds look_again_ REIDENT_GUARDED_BY(mutex_);
  std::chrono::steady_clock::time_point next_report_ REIDENT_GUARDED_BY(mutex_);
  Mutex callback_mutex_;  // taken before the other
  Callback callback_ REIDENT_GUARDED_BY(callback_mutex_);
  CondVar has_event_;
  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

}  // namespace reident
