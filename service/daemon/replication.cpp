#include "service/daemon/replication.hpp"

#include <algorithm>
#include <utility>

#include "service/support/log.hpp"

namespace reident {
namespace {

using namespace std::chrono_literals;
using storage::JournalPart;
using storage::Term;

constexpr std::size_t replicas_at_most = 64;
constexpr std::size_t part_bytes = 128U << 10;  // the middleware holds several of them
constexpr Instant report_interval = 200ms;
constexpr Instant rows_again_after = 400ms;
constexpr Instant partner_is_there = 1500ms;  // since it was heard

}  // namespace

Replication::Replication(const Config& config, Clock clock, dds::Participant& participant,
                         ArchiveWriter& writer, dds::WaitSet& ready, Listener listener)
    : config_(config),
      clock_(std::move(clock)),
      listener_(std::move(listener)),
      database_(config.database, storage::Database::Mode::read_only),
      registry_(database_),
      replicas_(participant),
      replica_(participant),
      task_(writer, ready) {
  ready.attach(replicas_);
}

Standing Replication::standing() const {
  const std::int64_t last = registry_.journal().last();
  return {registry_.journal().term_at(last), last, config_.strength};
}

std::optional<Replication::Partner> Replication::partner(Instant now) const {
  return partner_ && now - partner_->heard <= partner_is_there ? partner_ : std::nullopt;
}

std::vector<Term> Replication::term_of(std::int64_t position) const {
  std::vector<Term> found;
  for (Term& term : registry_.journal().terms())
    if (term.first <= position) found = {std::move(term)};
  return found;
}

void Replication::send(Replica::Kind kind, const std::string& receiver, JournalPart part,
                       std::vector<Term> terms) {
  Replica message;
  message.sender = config_.service_name;
  message.pair = config_.pair;
  message.receiver = receiver;
  message.kind = kind;
  message.part = std::move(part);
  message.terms = std::move(terms);
  // One that does not take it must not hold this thread up; it is sent again.
  replica_.write(message, [] { return true; });
}

void Replication::turn(const Turn& turn) {
  if (const std::string failure = task_.finish(); !failure.empty()) {
    if (failure != std::exchange(obstacle_, failure))
      log::error("pair", "rows of the other service cannot be recorded; it is tried again",
                 {{"error", failure}});
  }
  replicas_.take(replicas_at_most, [&](Replica&& message) {
    if (message.pair == config_.pair && message.sender != config_.service_name &&
        (message.receiver.empty() || message.receiver == config_.service_name))
      hear(std::move(message), turn);
  });
  if (turn.leads) {
    giving_up_.reset();
    obstacle_.clear();
    is_foreign_ = false;
    send_rows(turn);
  } else if (turn.now >= next_report_) {
    next_report_ = turn.now + report_interval;
    if (giving_up_ && !turn.leader.empty())
      send_given_up(turn.leader);
    else if (!is_foreign_)
      say_position(turn.leader);
  }
}

void Replication::say_position(const std::string& leader) {
  const std::int64_t last = registry_.journal().last();
  send(Replica::Kind::position, leader, {0, last, {}}, term_of(last));
}

void Replication::hear(Replica&& message, const Turn& turn) {
  using Kind = Replica::Kind;
  const bool is_of_leader = !turn.leads && message.sender == turn.leader;
  switch (message.kind) {
    case Kind::position:
      return hear_position(message, turn);
    case Kind::given_up:
      partner_ = Partner{message.sender, {}, false, turn.now};
      if (turn.leads) keep(std::move(message));
      return;
    case Kind::rows:
      if (is_of_leader) apply(std::move(message));
      return;
    case Kind::terms:
      if (is_of_leader) hear_terms(message);
      return;
    case Kind::kept:
      if (is_of_leader) give_up(message.part.last);
      return;
  }
}

// -- the leader

void Replication::hear_position(const Replica& report, const Turn& turn) {
  const std::int64_t last = report.part.last;
  const bool agrees =
      last == 0 || (last <= registry_.journal().last() && report.terms == term_of(last));
  partner_ =
      Partner{report.sender,
              {report.terms.empty() ? 0 : report.terms.back().number, last, 3 - config_.strength},
              turn.leads && agrees,
              turn.now};
  if (!turn.leads) return;
  if (last >= sent_until_) sent_until_ = 0;  // all that was sent has come
  if (!agrees)
    send(Replica::Kind::terms, report.sender, {0, registry_.journal().last(), {}},
         registry_.journal().terms());
}

void Replication::send_rows(const Turn& turn) {
  const auto follower = partner(turn.now);
  if (!follower || !follower->follows) return;
  if (sent_until_ > 0 && turn.now - sent_at_ < rows_again_after) return;
  const std::int64_t after = follower->standing.position;
  if (after >= registry_.journal().last()) return;
  JournalPart part = registry_.journal().part(after, part_bytes);
  sent_until_ = part.last;
  sent_at_ = turn.now;
  send(Replica::Kind::rows, follower->service, std::move(part));
}

void Replication::keep(Replica&& message) {
  if (task_.is_pending() || message.terms.size() != 1) return;
  const std::int64_t last = message.part.last;
  const std::string sender = message.sender;
  task_.post(
      [this, message = std::move(message)](storage::Registry& registry, auto&) {
        const Term& term = message.terms.front();
        registry.journal().keep_overruled(message.part, term.number, term.service, clock_());
      },
      [this, last, sender] {
        send(Replica::Kind::kept, sender, {0, last, {}});
        listener_.overruled();
      });
}

// -- the follower

void Replication::apply(Replica&& message) {
  if (task_.is_pending() || giving_up_) return;
  if (registry_.journal().is_of_no_pair()) return refuse(message.sender);
  const std::string leader = message.sender;
  task_.post(
      [this, part = std::move(message.part)](storage::Registry& registry,
                                             storage::Archive& archive) {
        const auto attempts = registry.journal().apply(part);
        if (!attempts.empty()) listener_.copied(attempts, registry, archive);
      },
      [this, leader] {
        obstacle_.clear();
        say_position(leader);
      });
}

void Replication::refuse(const std::string& leader) {
  is_foreign_ = true;
  obstacle_ = "its registry has nothing in common with that of " + leader +
              ": start it with an empty database, or with a backup of the other one's";
}

void Replication::hear_terms(const Replica& message) {
  if (task_.is_pending()) return;
  const auto journal = registry_.journal();
  const std::int64_t last = journal.last();
  const std::int64_t end = common_end(journal.terms(), last, message.terms, message.part.last);
  if (end == 0) return refuse(message.sender);
  if (end == last || giving_up_) return;
  log::warning("pair",
               "the other service has decided in a later term: what was decided here since "
               "is overruled",
               {{"leader", message.sender}, {"rows", last - end}});
  giving_up_ = GivingUp{end, end};
  next_report_ = {};
}

void Replication::send_given_up(const std::string& leader) {
  JournalPart part = registry_.journal().part(giving_up_->kept, part_bytes);
  std::vector<Term> term = term_of(giving_up_->kept + 1);
  send(Replica::Kind::given_up, leader, std::move(part), std::move(term));
}

void Replication::give_up(std::int64_t kept) {
  if (!giving_up_ || task_.is_pending() || kept <= giving_up_->kept) return;
  giving_up_->kept = kept;
  next_report_ = {};
  if (kept < registry_.journal().last()) return;
  task_.post([this, end = giving_up_->end](storage::Registry& registry,
                                           auto&) { registry.journal().overrule(end, clock_()); },
             [this] { giving_up_.reset(); });
}

}  // namespace reident
