#include "service/daemon/leadership_rule.hpp"

#include <algorithm>
#include <utility>

namespace reident {

LeadershipRule::LeadershipRule(int strength, Instant now)
    : strength_(strength), until_(now + start_wait), last_look_(now) {}

void LeadershipRule::hear_leader(std::int64_t term, const std::string& service, bool is_handed_over,
                                 Instant now) {
  latest_term_ = std::max(latest_term_, term);
  leader_term_ = term;
  leader_ = service;
  heard_leader_ = now;
  if (!is_handed_over || role_ == Role::leads) return;
  heard_leader_.reset();
  is_named_ = true;
  listen(now);
}

void LeadershipRule::hear_end() {
  heard_leader_.reset();
}

void LeadershipRule::hear_partner(const Standing& partner, Instant now) {
  latest_term_ = std::max(latest_term_, partner.term);
  partner_ = partner;
  heard_partner_ = now;
}

LeadershipRule::Step LeadershipRule::look_after_absence(Instant absence, Instant now) {
  if (absence <= lease / 2) return Step::none;
  // The partner may have taken over meanwhile; it says so within its first lease.
  const Instant wait = absence > forgotten_after ? absence_wait : start_wait;
  if (role_ == Role::leads) {
    if (absence <= lease) return Step::none;
    listen(now + wait);
    return Step::step_down;
  }
  if (absence > forgotten_after)
    listen(now + wait);
  else if (role_ == Role::follows)
    heard_leader_ = now;
  return Step::none;
}

LeadershipRule::Step LeadershipRule::look(const Standing& ours, Instant now) {
  const Instant absence = now - std::exchange(last_look_, now);
  if (const Step step = look_after_absence(absence, now); step != Step::none) return step;
  if (role_ == Role::leads) {
    if (!heard_leader_ || leader_term_ <= term_) return Step::none;
    role_ = Role::follows;
    return Step::step_down;
  }
  // One that does not know our last term would overrule it.
  if (hears_leader(now) && leader_term_ >= ours.term) {
    role_ = Role::follows;
    is_starting_ = is_named_ = false;
    return Step::none;
  }
  if (role_ == Role::follows) listen(now);
  const bool hears_partner = partner_ && now - heard_partner_ <= lease;
  if (!is_named_ && hears_partner && *partner_ > ours && now < until_ + patience) return Step::none;
  if (is_starting_ && hears_partner && *partner_ < ours) return Step::take_over;
  return now < until_ ? Step::none : Step::take_over;
}

LeadershipRule::Step LeadershipRule::look_while_unheard(Instant now) {
  last_look_ = now;
  heard_leader_.reset();
  const bool led = role_ == Role::leads;
  listen(now + patience);
  return led ? Step::step_down : Step::none;
}

void LeadershipRule::took_over(std::int64_t term) {
  role_ = Role::leads;
  is_starting_ = is_named_ = false;
  term_ = term;
  latest_term_ = std::max(latest_term_, term);
  heard_leader_.reset();
}

void LeadershipRule::hand_over(Instant now) {
  listen(now + patience);
}

std::int64_t LeadershipRule::next_term(std::int64_t last_of_journal) const {
  const std::int64_t next = std::max(latest_term_, last_of_journal) + 1;
  return (next - strength_) % 2 == 0 ? next : next + 1;
}

}  // namespace reident
