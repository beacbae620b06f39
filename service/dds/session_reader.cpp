#include "service/dds/session_reader.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "service/dds/loan.hpp"
#include "service/support/log.hpp"

namespace reident::dds {
namespace {

// The middleware's thread hands on what it has acknowledged as soon as there is room; it looks
// every 10 ms at the latest. A reader that stays empty for longer has all of it.
constexpr dds_duration_t handed_on_quiet = DDS_MSECS(25);
constexpr dds_duration_t drained_quiet = DDS_MSECS(150);
constexpr dds_duration_t drain_limit = DDS_SECS(1);

std::vector<dds_instance_handle_t> matched(dds_entity_t reader, const char* topic) {
  const dds_return_t count = check(dds_get_matched_publications(reader, nullptr, 0),
                                   "dds_get_matched_publications", topic);
  std::vector<dds_instance_handle_t> writers(static_cast<std::size_t>(count));
  const dds_return_t now =
      check(dds_get_matched_publications(reader, writers.data(), writers.size()),
            "dds_get_matched_publications", topic);
  writers.resize(std::min(writers.size(), static_cast<std::size_t>(now)));
  return writers;
}

}  // namespace

SessionReader::SessionReader(Participant& participant, SharedSession session,
                             const Profile& profile, const dds_topic_descriptor_t& descriptor,
                             const ReaderOptions& options)
    : participant_(participant),
      session_(std::move(session)),
      profile_(profile),
      options_(options),
      publications_(*session_, profile.topic),
      topic_(session_->made(dds_create_topic(session_->participant.get(), &descriptor,
                                             profile.topic, nullptr, nullptr),
                            "dds_create_topic", profile.topic, security::Direction::subscribe)),
      first_(make_endpoint(!is_volatile())) {}

SessionReader::Endpoint SessionReader::make_endpoint(bool transient_local) const {
  session_->require_valid(profile_.topic);
  const Qos qos = reader_qos(profile_, options_, transient_local);
  Endpoint endpoint;
  endpoint.reader = session_->made(
      dds_create_reader(session_->subscriber.get(), topic_.get(), qos.get(), nullptr),
      "dds_create_reader", profile_.topic, security::Direction::subscribe);
  endpoint.has_samples = {dds_create_readcondition(endpoint.reader.get(), DDS_ANY_STATE),
                          "dds_create_readcondition", profile_.topic};
  return endpoint;
}

void SessionReader::meet_writers() {
  const PublicationWatch::Unmatched unmatched = publications_.take();
  if (unmatched.best_effort && !warned_of_best_effort_) {
    log::warning("dds",
                 "a writer of the topic offers BEST_EFFORT and is not heard; make it RELIABLE",
                 {{"topic", profile_.topic}});
    warned_of_best_effort_ = true;
  }
  if (!unmatched.reliable_volatile || second_.reader || is_volatile()) return;
  second_ = make_endpoint(false);
  for (const dds_entity_t wait_set : wait_sets_) attach(wait_set, second_);
}

void SessionReader::attach_to(dds_entity_t wait_set) {
  wait_sets_.push_back(wait_set);
  check(dds_waitset_attach(wait_set, publications_.has_publications(), 0), "dds_waitset_attach",
        profile_.topic);
  for (const Endpoint* endpoint : {&first_, &second_}) attach(wait_set, *endpoint);
}

void SessionReader::attach(dds_entity_t wait_set, const Endpoint& endpoint) const {
  if (!endpoint.reader) return;
  check(dds_waitset_attach(wait_set, endpoint.has_samples.get(), 0), "dds_waitset_attach",
        profile_.topic);
}

bool SessionReader::is_heard_by_first(dds_instance_handle_t writer) {
  const auto known = keeps_history_.find(writer);
  if (known != keeps_history_.end()) return known->second;
  dds_builtintopic_endpoint_t* endpoint =
      dds_get_matched_publication_data(second_.reader.get(), writer);
  // The writer is gone already: rather the same sample twice than not at all.
  if (endpoint == nullptr) return false;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_qget_durability(endpoint->qos, &durability);
  dds_builtintopic_free_endpoint(endpoint);
  return keeps_history_[writer] = durability != DDS_DURABILITY_VOLATILE;
}

std::size_t SessionReader::take_some(const Endpoint& endpoint, std::size_t max, const Visit& visit,
                                     const Ended& ended) {
  const Loan loan(endpoint.reader.get(), max, profile_.topic);
  const bool is_second = &endpoint == &second_;
  for (std::size_t i = 0; i < loan.count; ++i) {
    const dds_sample_info_t& info = loan.infos[i];
    if (info.valid_data && !(is_second && is_heard_by_first(info.publication_handle)))
      visit(loan.samples[i], std::max<storage::Time>(info.source_timestamp, 0));
    if (ended && info.instance_state != DDS_IST_ALIVE) ended(loan.samples[i]);
  }
  return loan.count;
}

std::size_t SessionReader::take(std::size_t max, const Visit& visit, const Ended& ended) {
  meet_writers();
  std::size_t taken = 0;
  for (const Endpoint* endpoint : {&first_, &second_}) {
    while (endpoint->reader && taken < max) {
      const std::size_t count = take_some(*endpoint, max - taken, visit, ended);
      taken += count;
      if (count == 0) break;
    }
  }
  return taken;
}

std::size_t SessionReader::take_until_quiet(dds_duration_t quiet, dds_duration_t limit,
                                            const Visit& visit) {
  const Entity wait_set(dds_create_waitset(session_->participant.get()), "dds_create_waitset",
                        profile_.topic);
  for (const Endpoint* endpoint : {&first_, &second_}) attach(wait_set.get(), *endpoint);
  const dds_time_t deadline = dds_time() + limit;
  std::size_t visited = 0;
  do {
    visited += take(std::numeric_limits<std::size_t>::max(), visit);
  } while (dds_time() < deadline && check(dds_waitset_wait(wait_set.get(), nullptr, 0, quiet),
                                          "dds_waitset_wait", profile_.topic) > 0);
  return visited;
}

std::size_t SessionReader::drain(const Visit& visit) {
  return take_until_quiet(drained_quiet, drain_limit, visit);
}

// The deletion of a reader waits for the middleware's receive thread, and that thread waits for
// room in the reader: a full reader is emptied first, while nothing new can come in.
SessionReader::~SessionReader() {
  try {
    std::optional<Silence> silence;
    if (is_bounded()) {
      silence.emplace(participant_);
      take_until_quiet(handed_on_quiet, drain_limit, [](const void*, storage::Time) {});
    }
    second_ = {};
    first_ = {};
  } catch (const Error&) {  // the participant is gone, and its readers with it
  }
}

std::uint32_t SessionReader::matched_writers() {
  meet_writers();
  std::set<dds_instance_handle_t> writers;
  for (const Endpoint* endpoint : {&first_, &second_}) {
    if (!endpoint->reader) continue;
    const auto heard = matched(endpoint->reader.get(), profile_.topic);
    writers.insert(heard.begin(), heard.end());
  }
  return static_cast<std::uint32_t>(writers.size());
}

}  // namespace reident::dds
