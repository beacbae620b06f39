#include "service/dds/reader_core.hpp"

#include <utility>

#include "service/support/log.hpp"

namespace reident::dds {

ReaderCore::ReaderCore(Participant& participant, const Profile& profile,
                       const dds_topic_descriptor_t& descriptor, const ReaderOptions& options)
    : participant_(participant),
      profile_(profile),
      descriptor_(descriptor),
      options_(options),
      current_(make_reader(participant.impl().sessions.newest())) {}

std::unique_ptr<SessionReader> ReaderCore::make_reader(const SharedSession& session) const {
  return std::make_unique<SessionReader>(participant_, session, profile_, descriptor_, options_);
}

void ReaderCore::follow() {
  const SessionKeeper& sessions = participant_.impl().sessions;
  if (before_ && std::chrono::steady_clock::now() >= leave_) before_.reset();
  if (sessions.is_newest(current_->session()) || sessions.is_newest(refused_)) return;
  const SharedSession newest = sessions.newest();
  try {
    auto reader = make_reader(newest);
    for (const dds_entity_t wait_set : wait_sets_) reader->attach_to(wait_set);
    before_ = std::exchange(current_, std::move(reader));
    leave_ = std::chrono::steady_clock::now() + session_overlap;
    refused_.reset();
  } catch (const Error& error) {
    log::error("dds", "a reader stays with the old files of security", {{"error", error.what()}});
    refused_ = newest;
  }
}

std::size_t ReaderCore::take(std::size_t max, const Visit& visit, const Ended& ended) {
  follow();
  // What ends in the session before goes on in the newest one.
  const std::size_t taken = before_ ? before_->take(max, visit) : 0;
  return taken + current_->take(max - taken, visit, ended);
}

std::size_t ReaderCore::drain(const Visit& visit) {
  return (before_ ? before_->drain(visit) : 0) + current_->drain(visit);
}

std::uint32_t ReaderCore::matched_writers() {
  follow();
  return current_->matched_writers();
}

void ReaderCore::attach_to(dds_entity_t wait_set) {
  wait_sets_.push_back(wait_set);
  if (before_) before_->attach_to(wait_set);
  current_->attach_to(wait_set);
}

void ReaderCore::meet_writers() {
  follow();
  if (before_) before_->meet_writers();
  current_->meet_writers();
}

}  // namespace reident::dds
