// What readers and wait sets share: the reader of the newest session, and for a while that of the
// session before.
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "service/dds/session_reader.hpp"

namespace reident::dds {

/// Follows the participant into its newest session at its next call. While sessions overlap it
/// takes from both, so that some messages come twice, and none is lost. One thread at a time; calls
/// throw Error.
class ReaderCore {
 public:
  using Visit = SessionReader::Visit;
  using Ended = SessionReader::Ended;

  ReaderCore(Participant& participant, const Profile& profile,
             const dds_topic_descriptor_t& descriptor, const ReaderOptions& options);

  // As those of SessionReader.

  std::size_t take(std::size_t max, const Visit& visit, const Ended& ended = {});
  std::size_t drain(const Visit& visit);
  std::uint32_t matched_writers();
  void attach_to(dds_entity_t wait_set);
  void meet_writers();

 private:
  std::unique_ptr<SessionReader> make_reader(const SharedSession& session) const;
  /// Joins the newest session, and leaves the one before when that has overlapped for long enough.
  void follow();

  Participant& participant_;
  const Profile& profile_;
  const dds_topic_descriptor_t& descriptor_;
  const ReaderOptions options_;
  std::unique_ptr<SessionReader> current_;
  std::unique_ptr<SessionReader> before_;  // null but for a while after a change
  std::chrono::steady_clock::time_point leave_;
  SharedSession refused_;  // one that denies the topic
  std::vector<dds_entity_t> wait_sets_;
};

}  // namespace reident::dds
