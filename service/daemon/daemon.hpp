// The service: telemetry in, archive, windows, identification, gate, registry, versions out.
//
//   ingest thread -> bounded queue -> writer thread (owns the database for writing)
//                                        | stored, described
//                                     window feed -> identification threads (read-only databases)
//                                        ^               | attempt, version, decision
//                                        '- writer <-----' then publisher
//   command desk thread -> writer thread, then publisher, then the reply
//   history desk thread (a read-only database) -> pages of rows to whoever asks
//   league thread (a read-only database) -> writer thread, for scores and decisions; publisher
//                                           when the champion changes, window feed when the
//                                           equipment does
//   pair thread, where the service is one of two: who leads; rows to and from the other one
//                                           through the writer. Without leadership nothing is
//                                           recorded but telemetry, and nothing published
#pragma once

#include <atomic>
#include <optional>
#include <thread>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/archive_keeper.hpp"
#include "service/daemon/archive_writer.hpp"
#include "service/daemon/bounded_queue.hpp"
#include "service/daemon/command_desk.hpp"
#include "service/daemon/history_desk.hpp"
#include "service/daemon/ingest.hpp"
#include "service/daemon/league_watch.hpp"
#include "service/daemon/pair.hpp"
#include "service/daemon/publisher.hpp"
#include "service/daemon/repeated_error.hpp"
#include "service/daemon/service_watch.hpp"
#include "service/daemon/simulator_book.hpp"
#include "service/daemon/telemetry_watch.hpp"
#include "service/daemon/window_attempt.hpp"
#include "service/daemon/window_feed.hpp"
#include "service/dds/dds.hpp"
#include "service/support/parallel.hpp"

namespace reident {

class Daemon {
 public:
  /// Opens the database for writing, joins the domain, publishes every champion and takes up what
  /// an earlier run left. Throws storage::Error or dds::Error. The configuration must outlive it.
  Daemon(const Config& config, Clock clock, Clock uptime);
  /// Stops.
  ~Daemon();

  void start();
  /// Publishes the state of the service, and sees to what is due now and then; call about once a
  /// second.
  void heartbeat();
  /// Whether the threads that take and store telemetry both went on since this was true the last
  /// time; each does every two seconds. One that waits for a disk, or for the room that the disk
  /// makes, goes on. Of the main thread alone.
  bool goes_on();
  /// A thread ended by an error, which is logged: the service must be stopped.
  bool failed() const { return failed_; }
  /// Ends all threads: what was taken from the middleware is committed first, identification that
  /// runs is abandoned (its window is tried again at the next start). False when telemetry that
  /// was taken could not be stored.
  bool stop();

 private:
  std::thread spawn(const char* name, std::function<void()> body);
  void identify_windows();
  /// For the thread whose database `registry` reads.
  AttemptContext attempt_context(const storage::Registry& registry);
  /// Says once which ticks suit an equipment's telemetry.
  void advise(const WindowFeed::Job& job, const storage::Archive& archive,
              const storage::Registry& registry);
  /// False when the service stops before the window is decided.
  bool identify(const WindowFeed::Job& job, const storage::Archive& archive,
                const storage::Registry& registry);
  /// What follows from an attempt that was committed.
  void publish(const RecordedAttempt& attempt);
  void publish(const LeagueDecision& decided, const storage::Registry& registry);
  /// Whether this service may decide: one of no pair always.
  bool leads() const { return !pair_ || pair_->leads(); }
  Pair::Listener pair_listener();
  std::optional<storage::CommandOutcome> carry_out(const storage::Command& command,
                                                   const storage::Registry& reader);
  storage::CommandOutcome hand_over(const storage::Command& command);
  void answer_operators();
  void answer_history();
  void keep_leagues();

  const Config& config_;
  const Clock clock_, uptime_;
  const storage::Time started_;
  BoundedQueue<TelemetryEvent> queue_;
  WorkerPool search_;  // shared by the identification threads
  WindowFeed feed_;
  TelemetryWatch telemetry_;
  LeagueWatch leagues_;
  ArchiveWriter writer_;
  ArchiveKeeper keeper_;
  dds::Participant participant_;
  Publisher publisher_;
  CommandDesk desk_;
  HistoryDesk history_desk_;
  SimulatorBook simulators_;
  std::optional<Pair> pair_;
  std::optional<ServiceWatch> watch_;
  std::optional<Ingest> ingest_;  // ends before the middleware hears again
  /// What the jobs of one equipment leave for the next.
  struct Kept {
    WindowCache windows;
    RepeatedError failure{};
    bool is_advised = false;  // whether its ticks were looked at
  };
  /// By equipment, which has one job at a time: the job's thread owns its entry.
  std::vector<Kept> kept_;

  std::thread ingest_thread_, writer_thread_, desk_thread_, history_thread_, league_thread_,
      pair_thread_;
  std::vector<std::thread> identification_threads_;
  std::atomic<bool> stopping_ = false;
  std::atomic<bool> failed_ = false;
  bool has_stored_ = false, has_taken_ = false;  // since goes_on() was true
  std::atomic<std::uint64_t> attempts_ = 0, approvals_ = 0;
};

}  // namespace reident
