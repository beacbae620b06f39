#include "service/daemon/pair.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "service/security/material.hpp"
#include "service/support/log.hpp"
#include "service/support/utc_clock.hpp"

namespace reident {
namespace {

static_assert(LeadershipRule::lease == dds::leadership_lease);

using namespace std::chrono_literals;
using Step = LeadershipRule::Step;

constexpr std::size_t sayings_at_most = 64;
constexpr Instant turn_interval = 40ms;
constexpr Instant saying_interval = 100ms;                   // that this service leads
constexpr Instant alive_within = 5s;                         // the archive's thread
constexpr storage::Time overruled_for = 86'400'000'000'000;  // an alarm stays

Instant instant_now() {
  return Instant(steady_now());
}

}  // namespace

Pair::Pair(const Config& config, Clock clock, dds::Participant& participant, ArchiveWriter& writer,
           Listener listener)
    : config_(config),
      clock_(clock),
      participant_(participant),
      listener_(std::move(listener)),
      leaders_(participant),
      ready_(participant),
      replication_(config, std::move(clock), participant, writer, ready_,
                   {listener_.copied, [this] { listener_.overruled(replication_.registry()); }}),
      rule_(config.strength, instant_now()),
      writer_(writer),
      taking_over_(writer, ready_),
      sign_of_life_(writer, ready_) {
  ready_.attach(leaders_);
}

void Pair::run() {
  thread_ = std::this_thread::get_id();
  RepeatedError failure;
  while (!stopping_) {
    ready_.wait(turn_interval);
    try {
      turn();
      failure.succeeded();
    } catch (const storage::Error& error) {
      if (failure.is_news(error.what()))
        log::error("pair", "the registry cannot be read; it is tried again",
                   {{"error", error.what()}});
    } catch (const std::future_error&) {  // the archive's thread has ended
      break;
    }
  }
  if (is_leading()) {
    share_the_last();
    step_down();
  }
}

void Pair::share_the_last() {
  const Instant until = instant_now() + share_limit;
  try {
    for (Instant now = instant_now(); now < until && is_leading(); now = instant_now()) {
      turn();
      const auto partner = replication_.partner(now);
      if (!partner || !partner->follows ||
          partner->standing.position >= replication_.standing().position)
        return;
      ready_.wait(turn_interval);
    }
  } catch (const std::exception& error) {
    log::warning("pair", "the other service may lack the last rows", {{"error", error.what()}});
  }
}

void Pair::stop() {
  stopping_ = true;
  ready_.wake();
}

void Pair::turn() {
  const Instant now = instant_now();
  hear_leaders(now);
  replication_.turn({is_leading(), rule_.leader(), now});
  if (const auto partner = replication_.partner(now))
    rule_.hear_partner(partner->standing, partner->heard);
  const Standing ours = replication_.standing();
  take(is_unheard() ? rule_.look_while_unheard(now) : rule_.look(ours, now), ours);
  if (const std::string failure = taking_over_.finish();
      !failure.empty() && take_over_failure_.is_news(failure))
    log::error("pair", "a term cannot be recorded; it is tried again", {{"error", failure}});
  bool hands_over = false;
  {
    const MutexLock lock(mutex_);
    hands_over = std::exchange(hands_over_, false) && is_leading();
  }
  if (hands_over) {
    const auto partner = replication_.partner(now);
    leadership_->write({config_.pair, rule_.latest_term(), config_.service_name, ours.position,
                        partner ? partner->service : ""},
                       [] { return true; });
    rule_.hand_over(now);
    step_down();
  } else if (is_leading() && now >= next_saying_ && archive_works(now)) {
    say_that_it_leads(ours, now);
  }
  note(ours, now);
}

bool Pair::is_unheard() const {
  const auto material = participant_.material();
  return material && material->end <= clock_();
}

void Pair::hear_leaders(Instant now) {
  leaders_.take(
      sayings_at_most,
      [&](Leadership&& said) {
        if (said.pair != config_.pair || said.service == config_.service_name) return;
        rule_.hear_leader(said.term, said.service, said.successor == config_.service_name, now);
        const MutexLock lock(mutex_);
        seen_.leader_position = said.position;
      },
      {},
      [&](Leadership&& ended) {
        if (ended.pair == config_.pair && !is_leading()) rule_.hear_end();
      });
}

void Pair::take(Step step, const Standing& ours) {
  if (step == Step::step_down) {
    log::warning("pair", "leads no more", {{"term", ours.term}, {"leader", rule_.leader()}});
    step_down();
  } else if (step == Step::take_over && !taking_over_.is_pending() && !replication_.is_foreign()) {
    take_over(ours);
  }
}

void Pair::take_over(const Standing& ours) {
  const std::int64_t term = rule_.next_term(ours.term);
  taking_over_.post(
      [this, term](storage::Registry& registry, auto&) {
        registry.journal().begin_term(term, config_.service_name, clock_());
        said_at_ = instant_now().count();
        may_record_ = true;
      },
      [this, term] {
        take_over_failure_.succeeded();
        rule_.took_over(term);
        const auto strength =
            std::min<std::int64_t>(term, std::numeric_limits<std::int32_t>::max());
        dds::WriterOptions options;
        options.strength = static_cast<std::int32_t>(strength);
        leadership_.emplace(participant_, options);
        say_that_it_leads(replication_.standing(), instant_now());
        log::info("pair", "leads", {{"term", term}});
        listener_.leads(replication_.registry());
      });
}

void Pair::step_down() {
  may_record_ = false;
  leadership_.reset();
  {
    const MutexLock lock(mutex_);
    changed_.notify_all();  // whoever waits in share() holds what the listener needs
  }
  listener_.leads_no_more();
}

void Pair::say_that_it_leads(const Standing& ours, Instant now) {
  next_saying_ = now + saying_interval;
  leadership_->write({config_.pair, rule_.latest_term(), config_.service_name, ours.position, {}},
                     [] { return true; });
  said_at_ = instant_now().count();
}

bool Pair::archive_works(Instant now) {
  sign_of_life_.finish();
  if (!sign_of_life_.is_pending() && writer_.counts().last_error.empty()) {
    life_seen_ = now;
    sign_of_life_.post([](auto&, auto&) {}, {});
  }
  return now - life_seen_ < alive_within;
}

void Pair::note(const Standing& ours, Instant now) {
  const auto partner = replication_.partner(now);
  const bool is_alone = is_leading() && !(partner && partner->follows);
  std::optional<storage::Journal::Overruled> overruled;
  const bool looks = now >= next_overruled_check_;
  if (looks) {
    next_overruled_check_ = now + 1s;
    overruled = replication_.registry().journal().overruled_since(clock_() - overruled_for);
  }
  const MutexLock lock(mutex_);
  seen_.ours = ours;
  seen_.partner = partner;
  seen_.role = rule_.role();
  seen_.latest_term = std::max(rule_.latest_term(), ours.term);
  seen_.leader = is_leading() ? config_.service_name : rule_.leader();
  seen_.obstacle = replication_.obstacle();
  if (!is_alone)
    seen_.alone_since = {};
  else if (seen_.alone_since == Instant{})
    seen_.alone_since = now;
  seen_.now = now;
  if (looks) seen_.overruled = overruled;
  changed_.notify_all();
}

bool Pair::leads() const {
  return may_record_ && instant_now() - Instant(said_at_) < LeadershipRule::lease;
}

bool Pair::share(const storage::Registry& registry) {
  if (!leads()) return false;
  if (std::this_thread::get_id() == thread_) return true;  // it would wait for itself
  const std::int64_t last = registry.journal().last();
  const Instant until = instant_now() + share_limit;
  ready_.wake();
  const MutexLock lock(mutex_);
  while (may_record_ && !stopping_ && seen_.partner && seen_.partner->follows &&
         seen_.partner->standing.position < last) {
    const Instant left = until - instant_now();
    if (left <= Instant::zero()) {
      published_beyond_ = last;
      break;
    }
    changed_.wait_for(mutex_, left);
  }
  return leads();
}

std::string Pair::obstacle_to_hand_over() const {
  const MutexLock lock(mutex_);
  if (!seen_.partner || !seen_.partner->follows)
    return "the other service of the pair is not there, or does not follow: 'reident status' shows "
           "both";
  const std::int64_t behind = seen_.ours.position - seen_.partner->standing.position;
  constexpr std::int64_t few = 1000;
  if (behind > few)
    return fmt::format("{} lacks {} rows of the registry still: try again when it has them",
                       seen_.partner->service, behind);
  return {};
}

void Pair::hand_over() {
  const MutexLock lock(mutex_);
  hands_over_ = true;
  ready_.wake();
}

}  // namespace reident
