// This service's part in a pair: who leads, and whether a decision may be published.
// service/DESIGN.md, "A pair of services".
//
// One thread says and hears all that is on reident/Leadership and reident/Replica; it waits for
// nothing else, and asks the archive's thread to record.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/leadership_rule.hpp"
#include "service/daemon/repeated_error.hpp"
#include "service/daemon/replication.hpp"
#include "service/support/mutex.hpp"

namespace reident {

class Pair {
 public:
  /// What follows from a change; called on the pair's thread, but `copied` (Replication::Listener).
  struct Listener {
    std::function<void(const storage::Registry&)> leads;
    std::function<void()> leads_no_more;
    std::function<void(const storage::Registry&)> overruled;
    decltype(Replication::Listener::copied) copied;
  };

  /// What it is given must outlive it. Throws dds::Error or storage::Error.
  Pair(const Config& config, Clock clock, dds::Participant& participant, ArchiveWriter& writer,
       Listener listener);

  /// The thread's body: until stop(). Leadership ends with it, and the other one may take over.
  void run();
  void stop();

  // From here on for any thread.

  /// Whether this service may record and publish now.
  bool leads() const;
  /// Waits until the other one has all that `registry` holds: while it follows, and for
  /// `share_limit` at most, after which an alarm says that it is behind. False where this service
  /// does not lead.
  bool share(const storage::Registry& registry);
  /// Why leadership cannot be given to the other one now; empty where it can.
  std::string obstacle_to_hand_over() const;
  /// Gives it to the other one. Call when that has all (share()).
  void hand_over();
  /// Instance name of who leads, as far as this service knows; empty: nobody.
  std::string leader() const;
  /// Fills in what a status says about the pair.
  void describe(ServiceStatus& status) const;
  std::vector<storage::Alarm> alarms() const;

  static constexpr std::chrono::milliseconds share_limit{2000};

 private:
  bool is_leading() const { return leadership_.has_value(); }
  void turn();
  /// The certificate has ended: the middleware goes on, and nobody hears it.
  bool is_unheard() const;
  void hear_leaders(Instant now);
  void take(LeadershipRule::Step step, const Standing& ours);
  void take_over(const Standing& ours);
  void step_down();
  void say_that_it_leads(const Standing& ours, Instant now);
  /// False where the archive's thread has been stuck for long, or could store no telemetry.
  bool archive_works(Instant now);
  /// Has the other one take the rows that it lacks, before leadership ends.
  void share_the_last();
  void note(const Standing& ours, Instant now);

  const Config& config_;
  const Clock clock_;
  dds::Participant& participant_;
  const Listener listener_;
  dds::Reader<Leadership> leaders_;
  std::optional<dds::Writer<Leadership>> leadership_;  // while it leads
  dds::WaitSet ready_;
  Replication replication_;
  LeadershipRule rule_;
  const ArchiveWriter& writer_;
  PostedTask taking_over_;
  RepeatedError take_over_failure_;
  PostedTask sign_of_life_;
  Instant life_seen_{};
  Instant next_saying_{}, next_overruled_check_{};

  std::atomic<bool> stopping_ = false;
  std::atomic<bool> may_record_ = false;
  std::atomic<Instant::rep> said_at_ = 0;  // that it leads, at last
  std::atomic<std::thread::id> thread_;

  /// What other threads see.
  struct Seen {
    Standing ours;
    std::optional<Replication::Partner> partner;
    LeadershipRule::Role role = LeadershipRule::Role::listens;
    std::string leader;
    std::int64_t latest_term = 0;
    std::int64_t leader_position = 0;
    std::string obstacle;
    Instant alone_since{};  // it leads, and the other one does not follow; 0: not so
    Instant now{};
    std::optional<storage::Journal::Overruled> overruled;
  };
  mutable Mutex mutex_;
  CondVar changed_;
  Seen seen_ REIDENT_GUARDED_BY(mutex_);
  std::int64_t published_beyond_ REIDENT_GUARDED_BY(mutex_) = 0;  // what the other one had
  bool hands_over_ REIDENT_GUARDED_BY(mutex_) = false;
};

}  // namespace reident
