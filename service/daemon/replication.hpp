// The registry's rows on their way between the two services of a pair, on reident/Replica.
//
// The follower says how far its journal goes; the leader answers with what follows, so that each
// message is an acknowledgement and a question. Where the two journals do not agree, the follower
// first hands over what it recorded beyond their common end, and gives it up when the leader has
// it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/leadership_rule.hpp"
#include "service/daemon/posted_task.hpp"
#include "service/daemon/window_feed.hpp"
#include "service/dds/dds.hpp"

namespace reident {

/// One thread's. What it is given must outlive it.
class Replication {
 public:
  struct Listener {
    /// On the archive's thread: these attempts of the leader were recorded.
    std::function<void(const std::vector<std::int64_t>& attempts, storage::Registry&,
                       storage::Archive&)>
        copied;
    /// What the other service decided was overruled here.
    std::function<void()> overruled;
  };
  /// How things are in this turn of the thread.
  struct Turn {
    bool leads = false;
    std::string leader;  // whom this service follows; empty: nobody
    Instant now{};
  };

  /// Throws dds::Error or storage::Error.
  Replication(const Config& config, Clock clock, dds::Participant& participant,
              ArchiveWriter& writer, dds::WaitSet& ready, Listener listener);

  /// Hears what has come, and says what is due.
  void turn(const Turn& turn);

  const storage::Registry& registry() const { return registry_; }
  Standing standing() const;
  /// The other service while it is heard and does not lead: its name and how far it goes.
  struct Partner {
    std::string service;
    Standing standing;
    bool follows = false;  // this service, and agrees with it
    Instant heard{};
  };
  std::optional<Partner> partner(Instant now) const;
  /// Why this service cannot follow; empty where it can.
  const std::string& obstacle() const { return obstacle_; }
  /// Its registry is not that of the pair: it may neither follow nor lead.
  bool is_foreign() const { return is_foreign_; }

 private:
  struct GivingUp {
    std::int64_t end = 0;   // of what both have
    std::int64_t kept = 0;  // by the leader, until here
  };

  void hear(Replica&& message, const Turn& turn);
  void hear_position(const Replica& report, const Turn& turn);
  void hear_terms(const Replica& message);
  void refuse(const std::string& leader);
  void apply(Replica&& message);
  void keep(Replica&& message);
  void give_up(std::int64_t kept);
  void say_position(const std::string& leader);
  void send_given_up(const std::string& leader);
  void send_rows(const Turn& turn);
  void send(Replica::Kind kind, const std::string& receiver, storage::JournalPart part,
            std::vector<storage::Term> terms = {});
  /// The term of a row as a list of one; empty where the journal has no row.
  std::vector<storage::Term> term_of(std::int64_t position) const;

  const Config& config_;
  const Clock clock_;
  const Listener listener_;
  storage::Database database_;
  const storage::Registry registry_;
  dds::Reader<Replica> replicas_;
  dds::Writer<Replica> replica_;
  PostedTask task_;
  std::optional<Partner> partner_;
  std::optional<GivingUp> giving_up_;
  std::string obstacle_;
  bool is_foreign_ = false;
  std::int64_t sent_until_ = 0;  // rows on their way to the follower
  Instant sent_at_{};
  Instant next_report_{};
};

}  // namespace reident
