#include "service/daemon/daemon.hpp"

#include <chrono>
#include <limits>
#include <pthread.h>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "service/dds/network_cut.hpp"
#include "service/operations/commands.hpp"
#include "service/security/material.hpp"
#include "service/support/log.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/support/version.hpp"
#include "service/windows/ticks.hpp"
#include "storage/archive/holdings.hpp"

namespace reident {
namespace {

/// A command that is carried out on the file holds its lock for a moment.
storage::Database open_for_writing(const Config& config) {
  using namespace std::chrono_literals;
  const auto deadline = std::chrono::steady_clock::now() + 1s;
  while (true) {
    try {
      return {config.database, storage::Database::Mode::read_write, config.durability};
    } catch (const storage::Error& error) {
      if (error.kind() != storage::Error::Kind::locked ||
          std::chrono::steady_clock::now() >= deadline)
        throw;
    }
    std::this_thread::sleep_for(20ms);
  }
}

dds::Endpoint endpoint_of(const Config& config) {
  dds::Endpoint endpoint{config.domain, config.partition, config.security};
  if (config.cut > 0)
    endpoint.lease =
        dds::settings_for({std::chrono::nanoseconds(config.cut), config.rate}, 0).lease;
  return endpoint;
}

std::vector<storage::SimulatorState> known_simulators(const Config& config) {
  storage::Database database(config.database, storage::Database::Mode::read_only);
  return storage::Registry(database).simulators();
}

/// What is damaged in the file already; empty: nothing.
std::string damage_of(const storage::Database& database) {
  const std::size_t count = storage::damaged_chunks(database);
  if (count == 0) return {};
  return fmt::format(
      "{} chunks of samples cannot be decoded and were set aside. 'reident verify' "
      "lists them; archive their telemetry again.",
      count);
}

/// As many as a status has room for.
std::string equipment_text(const Config& config) {
  constexpr std::size_t most_bytes = 60'000;
  std::vector<std::string> names;
  std::size_t bytes = 0;
  for (const storage::EquipmentName& name : equipment_of(config)) {
    bytes += full_name(name).size() + 2;
    if (bytes > most_bytes) break;
    names.push_back(full_name(name));
  }
  return joined(names);
}

std::string security_text(const dds::Participant& participant) {
  const auto material = participant.material();
  return material ? security::description(*material) : "none";
}

IdentificationReport report_of(const RefreshResult& result) {
  IdentificationReport report;
  const storage::NewAttempt& attempt = result.attempt;
  report.spacecraft = attempt.spacecraft;
  report.equipment = attempt.equipment;
  report.window = attempt.window;
  report.trigger = attempt.trigger;
  report.outcome = attempt.outcome;
  report.reason = attempt.reason;
  report.time = attempt.time;
  constexpr double absent = std::numeric_limits<double>::quiet_NaN();
  const Evidence& evidence = result.evidence;
  report.order = result.candidate ? static_cast<int>(result.candidate->dynamics.order()) : 0;
  report.mrse_percent = result.candidate ? evidence.mrse_percent : absent;
  report.fit_percent = result.candidate ? evidence.fit_percent : absent;
  report.champion_mrse_percent = result.champion_mrse_percent;
  return report;
}

/// When the last window was tried; 0 before the first.
storage::Time last_entry(const storage::Registry& registry) {
  storage::HistoryFilter newest;
  newest.last = 1;
  const auto attempts = registry.attempts(newest);
  return attempts.empty() ? 0 : attempts.back().time;
}

void log_attempt(const IdentificationReport& report) {
  log::info("identify", "window decided",
            {{"equipment", report.spacecraft + "/" + report.equipment},
             {"window_end", time_text(report.window.end)},
             {"outcome", report.outcome},
             {"version", report.version},
             {"order", report.order},
             {"mrse_percent", report.mrse_percent},
             {"fit_percent", report.fit_percent},
             {"reason", report.reason}});
}

}  // namespace

Daemon::Daemon(const Config& config, Clock clock, Clock uptime)
    : config_(config),
      clock_(std::move(clock)),
      uptime_(std::move(uptime)),
      started_(clock_()),
      queue_({config.queue_frames, config.queue_mib << 20}),
      search_(usable_cores()),
      feed_(config, clock_, uptime_),
      telemetry_(config, clock_, uptime_, feed_),
      leagues_(config, feed_),
      writer_(open_for_writing(config), {.recent_samples = config.recent_samples}, queue_,
              config.batch_frames, config.batch_delay, telemetry_),
      keeper_(config, writer_, clock_),
      participant_(endpoint_of(config)),
      publisher_(
          participant_,
          [this](const storage::Registry& registry) { return !pair_ || pair_->share(registry); }),
      desk_(participant_, config.service_name, clock_, config.pair, [this] { return leads(); }),
      history_desk_(participant_, config.service_name, [this] { return leads(); }),
      simulators_(known_simulators(config), started_),
      ingest_(std::in_place, participant_, config, queue_, simulators_, clock_) {
  for (const SpacecraftConfig& spacecraft : config.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment)
      kept_.push_back({window_cache_of(spacecraft.name, equipment)});
  storage::Database database(config.database, storage::Database::Mode::read_only);
  const storage::Registry registry(database);
  feed_.recover(storage::Archive(database), registry);
  telemetry_.recover(storage::Archive(database), last_entry(registry));
  if (!config.pair.empty()) {
    feed_.pause(true);
    pair_.emplace(config, clock_, participant_, writer_, pair_listener());
  } else if (!registry.journal().is_of(config.service_name)) {
    writer_.post([this](storage::Registry& stored, auto&) {
      stored.journal().leave_pair(config_.service_name, clock_());
    });
  }
  watch_.emplace(ServiceWatch::Parts{config, clock_, uptime_, started_, participant_, writer_,
                                     telemetry_, simulators_, publisher_, damage_of(database),
                                     pair_ ? &*pair_ : nullptr});
  const std::size_t published = pair_ ? 0 : publisher_.publish_champions(registry);
  log::info("service", "started",
            {{"version", program_version()},
             {"database", config.database.string()},
             {"domain", config.domain},
             {"partition", config.partition},
             {"security", security_text(participant_)},
             {"champions", published},
             {"windows_pending", feed_.pending()}});
}

Daemon::~Daemon() {
  stop();
}

void Daemon::start() {
  writer_thread_ = spawn("archive", [this] { writer_.run(stopping_); });
  ingest_thread_ = spawn("ingest", [this] { ingest_->run(); });
  for (unsigned i = 0; i < config_.workers; ++i)
    identification_threads_.push_back(spawn("identify", [this] { identify_windows(); }));
  desk_thread_ = spawn("command", [this] { answer_operators(); });
  history_thread_ = spawn("history", [this] { answer_history(); });
  league_thread_ = spawn("league", [this] { keep_leagues(); });
  if (pair_) pair_thread_ = spawn("pair", [this] { pair_->run(); });
}

std::thread Daemon::spawn(const char* name, std::function<void()> body) try {
  return std::thread([this, name, body = std::move(body)] {
    pthread_setname_np(pthread_self(), name);  // for top, perf and debuggers
    try {
      body();
    } catch (const std::exception& error) {
      log::error(name, "ended by an error", {{"error", error.what()}});
      failed_ = true;
    }
  });
} catch (const std::system_error& error) {
  throw std::runtime_error(
      fmt::format("the thread {} cannot be started ({}): raise the limits of tasks and memory "
                  "(TasksMax, MemoryMax, ulimit -u -v)",
                  name, error.what()));
}

void Daemon::identify_windows() {
  storage::Database database(config_.database, storage::Database::Mode::read_only);
  const storage::Archive archive(database);
  const storage::Registry registry(database);
  while (const auto job = feed_.next()) {
    bool completed = false;
    RepeatedError& failure = kept_[job->window.equipment].failure;
    try {
      completed = identify(*job, archive, registry);
      failure.succeeded();
    } catch (const storage::Error& error) {
      if (failure.is_news(error.what()))
        log::error("identify", "window put off; it is tried again",
                   {{"equipment", *job->spacecraft + "/" + job->equipment->name},
                    {"error", error.what()}});
    }
    feed_.finished(*job, completed);
    if (completed)
      writer_.post([this, spacecraft = *job->spacecraft](auto&, storage::Archive& stored) {
        feed_.forget_settled(spacecraft, stored);
      });
  }
}

AttemptContext Daemon::attempt_context(const storage::Registry& registry) {
  return {{[this](const LeagueContext::Task& task) {
             writer_
                 .post([this, &task](storage::Registry& stored, storage::Archive& archive) {
                   if (!leads()) throw Stopped();
                   task(stored, archive);
                 })
                 .get();
           },
           clock_, [this] { return stopping_ || !leads(); },
           [this, &registry](const LeagueDecision& decided) { publish(decided, registry); }},
          config_.digest,
          [this](std::size_t count, const std::function<void(std::size_t)>& task) {
            search_.for_each(count, task);
          },
          &leagues_};
}

void Daemon::advise(const WindowFeed::Job& job, const storage::Archive& archive,
                    const storage::Registry& registry) {
  if (std::exchange(kept_[job.window.equipment].is_advised, true)) return;
  if (const auto advice =
          advised_phase(archive, registry, *job.spacecraft, *job.equipment, job.window.window.end))
    log::warning("identify", *advice, {{"equipment", *job.spacecraft + "/" + job.equipment->name}});
}

bool Daemon::identify(const WindowFeed::Job& job, const storage::Archive& archive,
                      const storage::Registry& registry) {
  const AttemptContext context = attempt_context(registry);
  advise(job, archive, registry);
  try {
    const auto attempt =
        attempt_window(job, archive, registry, kept_[job.window.equipment].windows, context);
    if (attempt) publish(*attempt);
    return attempt.has_value();
  } catch (const Stopped&) {
    return false;
  } catch (const std::future_error&) {  // the writer has ended
    return false;
  }
}

void Daemon::publish(const RecordedAttempt& attempt) {
  const RefreshResult& result = attempt.result;
  ++attempts_;
  telemetry_.tried(result.attempt.time);
  IdentificationReport report = report_of(result);
  report.version = attempt.version;
  publisher_.report(report);
  log_attempt(report);
}

void Daemon::publish(const LeagueDecision& decided, const storage::Registry& registry) {
  const storage::Version& version = decided.version;
  using enum storage::DecisionKind;
  const storage::DecisionKind kind = decided.decision.kind;
  if (kind == approve) ++approvals_;
  if (kind != wait && kind != reject)
    publisher_.publish_champion(registry, {version.spacecraft, version.equipment});
  log::info("league", "version decided",
            {{"equipment", version.spacecraft + "/" + version.equipment},
             {"version", version.number},
             {"decision", name(kind)},
             {"reason", decided.decision.reason}});
}

Pair::Listener Daemon::pair_listener() {
  return {
      [this](const storage::Registry& registry) {
        leagues_.read_again();
        const std::size_t published = publisher_.publish_champions(registry, true);
        feed_.pause(false);
        log::info("pair", "decides from now on", {{"champions", published}});
      },
      [this] {
        feed_.pause(true);
        publisher_.retire();
      },
      [this](const storage::Registry& registry) { publisher_.publish_champions(registry, true); },
      [this](const std::vector<std::int64_t>& attempts, storage::Registry& registry,
             storage::Archive& archive) {
        for (const std::int64_t id : attempts) {
          const auto attempt = registry.attempt(id);
          telemetry_.tried(attempt->time);
          archive.seal(attempt->spacecraft, attempt->window.end);
          feed_.tried_elsewhere({attempt->spacecraft, attempt->equipment}, attempt->window);
          feed_.forget_settled(attempt->spacecraft, archive);
        }
      }};
}

storage::CommandOutcome Daemon::hand_over(const storage::Command& command) {
  if (!pair_) return {false, "this service is of no pair: there is nobody to give leadership to"};
  const std::string obstacle = pair_->obstacle_to_hand_over();
  if (!obstacle.empty()) return {false, obstacle};
  return {true, fmt::format("{} gives leadership to the other one of {}, asked by {}",
                            config_.service_name, config_.pair, command.actor)};
}

std::optional<storage::CommandOutcome> Daemon::carry_out(const storage::Command& command,
                                                         const storage::Registry& reader) {
  const auto does_not_lead = [this] {
    const std::string leader = pair_->leader();
    return storage::CommandOutcome{
        false, leader.empty() ? "no service of the pair leads now: try again"
                              : fmt::format("{} does not lead: give the command to {}",
                                            config_.service_name, leader)};
  };
  if (!leads()) return does_not_lead();
  bool hands_over = false;  // not for a copy of a command: leadership was given away by then
  const CommandContext context{
      equipment_of(config_),
      [this](const storage::EquipmentName& equipment, const std::string& cause) {
        return feed_.ask(equipment.spacecraft, equipment.equipment, cause);
      },
      [&](const storage::Command& one) {
        hands_over = true;
        return hand_over(one);
      }};
  storage::CommandOutcome outcome;
  try {
    writer_
        .post([&](storage::Registry& registry, auto&) {
          if (!leads()) throw Stopped();
          outcome = execute(command, registry, context, clock_());
        })
        .get();
  } catch (const Stopped&) {
    return does_not_lead();
  } catch (const std::future_error&) {  // the writer has ended
    return std::nullopt;
  }
  // One that the other service may not have is sent again, and answered by whoever leads then.
  if (pair_ && !pair_->share(reader)) return std::nullopt;
  if (!outcome.ok) return outcome;
  if (hands_over) pair_->hand_over();
  for (const storage::EquipmentName& equipment : reader.equipment())
    if (equipment.equipment == command.equipment) publisher_.publish_champion(reader, equipment);
  return outcome;
}

void Daemon::answer_operators() {
  storage::Database database(config_.database, storage::Database::Mode::read_only);
  const storage::Registry reader(database);
  desk_.run([&](const storage::Command& command) { return carry_out(command, reader); });
}

void Daemon::answer_history() {
  storage::Database database(config_.database, storage::Database::Mode::read_only);
  history_desk_.run(
      [&database](const HistoryQuery& query) { return history::answer(database, query); });
}

void Daemon::keep_leagues() {
  storage::Database database(config_.database, storage::Database::Mode::read_only);
  const storage::Archive archive(database);
  const storage::Registry registry(database);
  const AttemptContext context = attempt_context(registry);
  std::uint64_t seen = 0;
  try {
    while (feed_.wait_for_telemetry(seen)) try {
        leagues_.look(archive, registry, context);
      } catch (const Stopped&) {  // the other service of the pair leads
      }
  } catch (const std::future_error&) {  // the writer has ended
  }
}

void Daemon::heartbeat() {
  keeper_.look();
  watch_->look();
  const ArchiveWriter::Counts stored = writer_.counts();
  ServiceStatus status;
  status.service = config_.service_name;
  status.program_version = program_version();
  status.started = started_;
  status.time = clock_();
  status.frames_received = ingest_->frames_received();
  status.frames_rejected = ingest_->frames_rejected();
  status.descriptors_rejected = ingest_->descriptors_rejected();
  status.samples_stored = stored.stored;
  status.duplicates = stored.duplicates;
  status.conflicts = stored.conflicts;
  status.late = stored.late;
  status.sequence_missing = stored.sequence_missing;
  status.clock_jumps = feed_.clock_jumps();
  status.queue_length = writer_.backlog();
  status.queue_waits = queue_.waits();
  status.windows_pending = feed_.pending();
  status.attempts = attempts_;
  status.approvals = approvals_;
  status.newest_telemetry = feed_.newest_telemetry();
  status.last_error = stored.last_error.empty() ? stored.last_damage : stored.last_error;
  status.failing_champions = leagues_.failing();
  status.alarms = watch_->text();
  status.equipment = equipment_text(config_);
  if (pair_) pair_->describe(status);
  if (const auto material = participant_.material()) status.certificate_end = material->end;
  publisher_.status(status);
}

bool Daemon::goes_on() {
  has_stored_ |= writer_.goes_on();
  has_taken_ |= ingest_->goes_on();
  if (!has_stored_ || !has_taken_) return false;
  has_stored_ = has_taken_ = false;
  return true;
}

bool Daemon::stop() {
  if (stopping_.exchange(true)) return true;
  desk_.stop();
  if (desk_thread_.joinable()) desk_thread_.join();
  history_desk_.stop();
  if (history_thread_.joinable()) history_thread_.join();
  feed_.stop();
  if (league_thread_.joinable()) league_thread_.join();
  if (pair_) pair_->stop();
  if (pair_thread_.joinable()) pair_thread_.join();
  ingest_->stop();
  if (ingest_thread_.joinable()) ingest_thread_.join();
  queue_.close();
  if (writer_thread_.joinable()) writer_thread_.join();
  for (std::thread& thread : identification_threads_) thread.join();
  const std::uint64_t frames = ingest_->frames_received();
  ingest_.reset();
  watch_.reset();
  pair_.reset();
  participant_.hear_again();  // for the acknowledgments that the publisher's writers wait for
  const ArchiveWriter::Counts stored = writer_.counts();
  if (stored.lost > 0)
    log::error("archive",
               "telemetry could not be stored; a gateway that keeps history sends it again",
               {{"frames", stored.lost}, {"error", stored.last_error}});
  log::info("service", "stopped",
            {{"frames", frames},
             {"samples_stored", stored.stored},
             {"attempts", attempts_.load()},
             {"approvals", approvals_.load()}});
  return stored.lost == 0;
}

}  // namespace reident
