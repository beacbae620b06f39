#include "service/client/simulator_client.hpp"

#include <algorithm>
#include <csignal>
#include <exception>
#include <set>
#include <unistd.h>
#include <utility>

#include "service/support/program_identity.hpp"
#include "service/support/utc_clock.hpp"

namespace reident {
namespace {

using namespace std::chrono_literals;
using SteadyClock = std::chrono::steady_clock;

constexpr auto report_period = 5s;  // of what runs, to the service
constexpr auto soonest_look = 1ms;  // whether a run took what was posted
constexpr auto latest_look = 250ms;

storage::EquipmentName name_of(const ModelVersion& version) {
  return {version.model.spacecraft, version.model.equipment};
}

std::string name_of(std::int64_t version) {
  return "version " + std::to_string(version);
}

std::optional<ModelCache> cache_of(const SimulatorClientOptions& options) {
  if (!options.cache) return std::nullopt;
  return ModelCache(*options.cache, options.endpoint.partition);
}

std::optional<std::string> named_twice(const std::vector<DeclaredSignal>& signals) {
  std::set<std::string> names;
  for (const DeclaredSignal& signal : signals)
    if (!names.insert(signal.name).second) return signal.name;
  return std::nullopt;
}

/// A thread that takes no signal: they are the simulator's.
template <class Work>
std::thread quiet_thread(Work work) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(work));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

SimulatorEvent event_of(SimulatorEvent::Kind kind, const ModelVersion& version,
                        const Arrival& arrival, std::string text) {
  SimulatorEvent event;
  event.kind = kind;
  event.equipment = name_of(version);
  event.text = std::move(text);
  event.version = version.number;
  event.from_cache = arrival.from_cache;
  event.time = arrival.received;
  event.decided = version.decided;
  event.published = arrival.published;
  return event;
}

}  // namespace

std::string default_simulator_name() {
  return host_name() + "-" + std::to_string(::getpid());
}

SimulatorClient::SimulatorClient(const SimulatorClientOptions& options)
    : participant_(options.endpoint),
      ready_(participant_),
      models_(participant_, options.subscription, cache_of(options)),
      look_again_(latest_look),
      next_report_(SteadyClock::now() + report_period) {
  {
    const MutexLock lock(mutex_);
    models_.attach_to(ready_);
    models_.poll(listener());
  }
  thread_ = quiet_thread([this] { work(); });
}

SimulatorClient::~SimulatorClient() {
  stops_ = true;
  ready_.wake();
  thread_.join();
}

void SimulatorClient::work() {
  while (!stops_) {
    try {
      ready_.wait(patience());
      look();
      deliver();
    } catch (const std::exception& error) {
      tell_fault(error.what());
      std::this_thread::sleep_for(latest_look);  // the middleware may answer again
    }
  }
}

void SimulatorClient::tell_fault(const char* what) {
  const MutexLock lock(mutex_);
  SimulatorEvent event;
  event.kind = SimulatorEvent::Kind::fault;
  event.text = std::string("the runs go on with the versions that they have: ") + what;
  event.time = utc_now();
  say(std::move(event));
}

void SimulatorClient::tell_unpublished() {
  for (Run& run : runs_) {
    if (!run.say_unpublished || SteadyClock::now() < *run.say_unpublished) continue;
    run.say_unpublished.reset();
    const storage::EquipmentName name{run.runner->spacecraft(), run.runner->equipment()};
    const auto* newest = models_.newest(name);
    if (newest != nullptr && !newest->arrival.from_cache) continue;
    SimulatorEvent event;
    event.kind = SimulatorEvent::Kind::unpublished;
    event.equipment = name;
    event.text = models_.unpublished_text(name);
    event.time = utc_now();
    say(std::move(event));
  }
}

std::chrono::nanoseconds SimulatorClient::patience() {
  const MutexLock lock(mutex_);
  auto next = next_report_;
  for (const Run& run : runs_)
    if (run.say_unpublished) next = std::min(next, *run.say_unpublished);
  const auto until_report = std::chrono::nanoseconds(next - SteadyClock::now());
  const bool any_waits = std::any_of(runs_.begin(), runs_.end(),
                                     [](const Run& run) { return run.runner->is_waiting(); });
  if (!any_waits) return std::max<std::chrono::nanoseconds>(until_report, 1ns);
  look_again_ = std::min<std::chrono::nanoseconds>(2 * look_again_, latest_look);
  return look_again_;
}

void SimulatorClient::look() {
  const MutexLock lock(mutex_);
  models_.poll(listener());
  for (Run& run : runs_) collect(run);
  tell_unpublished();
  if (SteadyClock::now() < next_report_) return;
  next_report_ = SteadyClock::now() + report_period;
  for (Run& run : runs_) {
    const RunState& state = run.runner->last_state();
    if (state.version == run.told.version) acknowledge(run, state);
    run.runner->ask_state();
  }
}

ModelSubscriber::Listener SimulatorClient::listener() {
  using Kind = SimulatorEvent::Kind;
  ModelSubscriber::Listener listener;
  listener.adopt = [this](const ModelVersion& version,
                          const Arrival& arrival) REIDENT_REQUIRES(mutex_) {
    if (Run* run = find(name_of(version))) take_in(*run, {version, arrival});
    say(event_of(Kind::available, version, arrival,
                 name_of(version.number) + (arrival.from_cache ? " was kept from an earlier run"
                                            : version.rollback ? " is the champion again"
                                                               : " is the champion")));
  };
  listener.confirm = [this](const ModelVersion& version,
                            const Arrival& arrival) REIDENT_REQUIRES(mutex_) {
    Run* run = find(name_of(version));
    if (run != nullptr && run->posted && run->posted->version.number == version.number) {
      run->posted->arrival = arrival;
      run->told.from_cache = false;
      if (run->told.version > 0) models_.acknowledge(name_of(version), run->told);
    }
    say(event_of(Kind::available, version, arrival,
                 name_of(version.number) + ", kept from an earlier run, is still the champion"));
  };
  listener.refuse = [this](const ModelSubscriber::Refusal& refusal) REIDENT_REQUIRES(mutex_) {
    SimulatorEvent event;
    event.kind = Kind::refused;
    event.equipment = refusal.equipment;
    event.version = refusal.version;
    event.text = name_of(refusal.version) + " is refused: " + refusal.reason;
    event.time = utc_now();
    say(std::move(event));
  };
  listener.cache_fault = [this](const CacheFault& fault) REIDENT_REQUIRES(mutex_) {
    SimulatorEvent event;
    event.kind = Kind::cache;
    event.equipment = fault.equipment;
    event.text = fault.reason;
    event.time = utc_now();
    say(std::move(event));
  };
  return listener;
}

void SimulatorClient::take_in(Run& run, const ModelSubscriber::Verified& verified) {
  auto made = PreparedModel::make(verified.version, run.runner->declaration());
  if (const auto* reason = std::get_if<std::string>(&made)) {
    offer(run, verified, "it cannot run here: " + *reason);
  } else if (run.posted && !same_signals(run.posted->version.model, verified.version.model)) {
    offer(run, verified,
          "its inputs, outputs or period are others than those of " +
              name_of(run.posted->version.number));
  } else {
    post(run, std::get<std::unique_ptr<PreparedModel>>(std::move(made)), verified);
  }
}

void SimulatorClient::offer(Run& run, const ModelSubscriber::Verified& verified,
                            const std::string& reason) {
  run.offered = verified;
  run.told.offered_version = verified.version.number;
  models_.acknowledge(name_of(verified.version), run.told);
  say(event_of(SimulatorEvent::Kind::offered, verified.version, verified.arrival,
               name_of(verified.version.number) + " is offered: " + reason));
}

void SimulatorClient::post(Run& run, std::unique_ptr<PreparedModel> model,
                           const ModelSubscriber::Verified& verified) {
  run.runner->post(std::move(model), verified.arrival);
  run.posted = verified;
  run.offered.reset();
  run.told.offered_version = 0;
  look_again_ = soonest_look;
}

void SimulatorClient::collect(Run& run) {
  const storage::EquipmentName name{run.runner->spacecraft(), run.runner->equipment()};
  run.runner->collect([&](const EquipmentRunner::Swapped& swapped) REIDENT_REQUIRES(mutex_) {
    const RunState& state = swapped.state;
    run.told.from_cache = run.posted->version.number == state.version
                              ? run.posted->arrival.from_cache
                              : swapped.arrival.from_cache;
    acknowledge(run, state);
    SimulatorEvent event;
    event.kind = SimulatorEvent::Kind::swapped;
    event.equipment = name;
    event.text = name_of(state.version) + " runs";
    event.version = state.version;
    event.from_cache = run.told.from_cache;
    event.time = state.swapped;
    event.decided = state.decided;
    event.published = swapped.arrival.published;
    event.remaining_step = state.remaining_step;
    event.transition_steps = state.transition_steps;
    event.matched_rows = swapped.rows;
    say(std::move(event));
  });
}

void SimulatorClient::acknowledge(Run& run, const RunState& state) {
  RunningModel& told = run.told;
  told.version = state.version;
  told.mode = state.version == 0 ? "" : state.is_following ? "following" : "free";
  told.decided = state.decided;
  told.since = state.swapped;
  told.mrse_percent = state.mrse_percent;
  told.remaining_step = state.remaining_step;
  told.transition_steps = state.transition_steps;
  told.steps = state.steps;
  told.steps_outside = state.steps_outside;
  told.steps_missing = state.steps_missing;
  models_.acknowledge({run.runner->spacecraft(), run.runner->equipment()}, told);
}

void SimulatorClient::say(SimulatorEvent event) {
  if (events_.size() == most_events) events_.pop_front();
  events_.push_back(std::move(event));
  has_event_.notify_all();
}

void SimulatorClient::deliver() {
  const MutexLock calling(callback_mutex_);
  if (!callback_) return;
  std::deque<SimulatorEvent> events;
  {
    const MutexLock lock(mutex_);
    events.swap(events_);
  }
  for (const SimulatorEvent& event : events) callback_(event);
}

std::optional<SimulatorEvent> SimulatorClient::next_event(std::chrono::milliseconds timeout) {
  const auto deadline = SteadyClock::now() + timeout;
  const MutexLock lock(mutex_);
  while (events_.empty() && timeout != 0ms) {
    if (timeout < 0ms) {
      has_event_.wait(mutex_);
    } else if (!has_event_.wait_for(mutex_, deadline - SteadyClock::now())) {
      break;
    }
  }
  if (events_.empty()) return std::nullopt;
  SimulatorEvent event = std::move(events_.front());
  events_.pop_front();
  return event;
}

void SimulatorClient::on_event(Callback callback) {
  {
    const MutexLock calling(callback_mutex_);
    callback_ = std::move(callback);
  }
  ready_.wake();  // for the events that are kept
}

SimulatorClient::Run* SimulatorClient::find(const storage::EquipmentName& equipment) {
  const auto found = std::find_if(runs_.begin(), runs_.end(), [&equipment](const Run& run) {
    return run.runner->spacecraft() == equipment.spacecraft &&
           run.runner->equipment() == equipment.equipment;
  });
  return found == runs_.end() ? nullptr : &*found;
}

std::variant<EquipmentRunner*, std::string> SimulatorClient::open(
    const storage::EquipmentName& equipment, Declaration declaration) {
  if (declaration.outputs.empty()) return "no output is declared";
  for (const auto* signals : {&declaration.inputs, &declaration.outputs})
    if (const auto name = named_twice(*signals)) return *name + " is declared twice";
  const MutexLock lock(mutex_);
  if (find(equipment) != nullptr)
    return equipment.spacecraft + "/" + equipment.equipment +
           " has a runner already; close it, or open another client";
  Run& run = runs_.emplace_back();
  run.runner = std::make_unique<EquipmentRunner>(equipment.spacecraft, equipment.equipment,
                                                 std::move(declaration));
  run.say_unpublished = SteadyClock::now() + version_within;
  if (const auto* newest = models_.newest(equipment)) take_in(run, *newest);
  ready_.wake();  // it may be waited for sooner now
  return run.runner.get();
}

void SimulatorClient::close(EquipmentRunner& runner) {
  const MutexLock lock(mutex_);
  const storage::EquipmentName name{runner.spacecraft(), runner.equipment()};
  std::erase_if(runs_, [&runner](const Run& run) { return run.runner.get() == &runner; });
  models_.acknowledge(name, {});
}

std::optional<std::string> SimulatorClient::accept(EquipmentRunner& runner) {
  const MutexLock lock(mutex_);
  Run& run = *find({runner.spacecraft(), runner.equipment()});
  if (!run.offered) return "no version is offered";
  const ModelSubscriber::Verified offered = *run.offered;
  auto made = PreparedModel::make(offered.version, runner.declaration());
  if (const auto* reason = std::get_if<std::string>(&made))
    return name_of(offered.version.number) + " cannot run here: " + *reason;
  post(run, std::get<std::unique_ptr<PreparedModel>>(std::move(made)), offered);
  ready_.wake();
  return std::nullopt;
}

SimulatorClient::VersionState SimulatorClient::version_state(const EquipmentRunner& runner) {
  const MutexLock lock(mutex_);
  const Run* run = find({runner.spacecraft(), runner.equipment()});
  return {run->offered ? run->offered->version.number : 0,
          run->posted && run->posted->arrival.from_cache};
}

std::optional<ModelVersion> SimulatorClient::newest(const storage::EquipmentName& equipment) {
  const MutexLock lock(mutex_);
  const auto* newest = models_.newest(equipment);
  return newest == nullptr ? std::nullopt : std::optional(newest->version);
}

}  // namespace reident
