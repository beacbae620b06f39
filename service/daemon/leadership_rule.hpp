// When a service of a pair leads, and when it does not. Not thread-safe; no clock, no topic: both
// are arguments, so that tests own them. service/DESIGN.md, "A pair of services", has the rules.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <optional>
#include <string>

namespace reident {

/// Since any moment, by a clock that never goes back.
using Instant = std::chrono::nanoseconds;

/// How far a journal goes; of two services that wait to lead, the one that goes further does.
struct Standing {
  std::int64_t term = 0;
  std::int64_t position = 0;
  int strength = 0;
  auto operator<=>(const Standing&) const = default;
};

class LeadershipRule {
 public:
  enum class Role { listens, follows, leads };
  enum class Step { none, take_over, step_down };

  /// `strength` is 1 or 2. Listens first.
  LeadershipRule(int strength, Instant now);

  /// The partner says that it leads. `is_handed_over`: it gives leadership to this service.
  void hear_leader(std::int64_t term, const std::string& service, bool is_handed_over, Instant now);
  /// Nobody says so any more: the middleware knows it before the lease has passed.
  void hear_end();
  /// The partner is there and does not lead.
  void hear_partner(const Standing& partner, Instant now);

  /// What is to be done now. Call it several times within a lease: who was away for longer than
  /// that, stopped or without a processor, no longer leads and believes no silence that it met.
  Step look(const Standing& ours, Instant now);
  /// In the place of look() while nobody can hear this service, nor it the partner: it leads no
  /// more, and believes no silence until `patience` has passed behind that.
  Step look_while_unheard(Instant now);
  /// The step was taken: this service leads in this term.
  void took_over(std::int64_t term);
  /// This service gives leadership away: it leads again only if nobody takes it.
  void hand_over(Instant now);

  Role role() const { return role_; }
  /// Whom it follows; empty where it follows nobody.
  std::string leader() const { return role_ == Role::follows ? leader_ : std::string(); }
  /// The latest term that it has heard of.
  std::int64_t latest_term() const { return latest_term_; }
  /// The number of a term that begins now: above all that were heard of, even for the strength 2
  /// and odd for 1.
  std::int64_t next_term(std::int64_t last_of_journal) const;

  static constexpr Instant lease = std::chrono::seconds(1);
  /// How long it listens after its start.
  static constexpr Instant start_wait = std::chrono::seconds(2);
  /// The middleware of one that was away for longer has forgotten the partner, and finds it again
  /// within `absence_wait`.
  static constexpr Instant forgotten_after = std::chrono::seconds(5);
  static constexpr Instant absence_wait = std::chrono::seconds(12);
  /// For one that goes further, or was named as the successor.
  static constexpr Instant patience = std::chrono::seconds(6);

 private:
  bool hears_leader(Instant now) const { return heard_leader_ && now - *heard_leader_ <= lease; }
  void listen(Instant until) { role_ = Role::listens, until_ = until; }
  /// What follows from the time since the last look.
  Step look_after_absence(Instant absence, Instant now);

  const int strength_;
  Role role_ = Role::listens;
  Instant until_;  // it listens
  Instant last_look_;
  bool is_starting_ = true;
  bool is_named_ = false;  // as the successor
  std::int64_t term_ = 0;  // that it leads in
  std::int64_t latest_term_ = 0;
  std::int64_t leader_term_ = 0;
  std::string leader_;
  std::optional<Instant> heard_leader_;
  std::optional<Standing> partner_;
  Instant heard_partner_{};
};

}  // namespace reident
