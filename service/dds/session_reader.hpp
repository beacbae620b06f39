// A reader within one session, whatever its message is: entities, loans, and which writers it
// hears.
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "service/dds/domain.hpp"
#include "service/dds/publication_watch.hpp"
#include "service/dds/qos.hpp"

namespace reident::dds {

/// A TRANSIENT_LOCAL reader gets the kept history of writers that keep some, and does not match
/// volatile writers at all; a volatile reader matches both and gets no history. So the first reader
/// asks for history, and when a writer without any is discovered, a second, volatile one joins it,
/// whose samples of history-keeping writers are skipped. One thread at a time; calls throw Error.
class SessionReader {
 public:
  /// `wire` is the topic's C type, lent until the visit returns. `sent`: by the writer's clock; 0
  /// where it did not say. A visit must not throw.
  using Visit = std::function<void(const void* wire, storage::Time sent)>;
  /// `wire` has its key alone.
  using Ended = std::function<void(const void* wire)>;

  SessionReader(Participant& participant, SharedSession session, const Profile& profile,
                const dds_topic_descriptor_t& descriptor, const ReaderOptions& options);
  /// Empties a bounded reader first, since its deletion would wait for the middleware's thread,
  /// which waits for room. Takes a second at most; what it throws away was acknowledged.
  ~SessionReader();
  SessionReader(const SessionReader&) = delete;
  SessionReader& operator=(const SessionReader&) = delete;

  /// Visits at most `max` samples and removes them; returns how many were removed. Calls `ended`
  /// where nobody writes a key any more.
  std::size_t take(std::size_t max, const Visit& visit, const Ended& ended = {});
  /// Takes until nothing more comes, for a second at most.
  std::size_t drain(const Visit& visit);
  /// Writers that one of the two readers hears now.
  std::uint32_t matched_writers();
  const SharedSession& session() const { return session_; }

  /// Lets the wait set wake for this reader: for samples, and for writers that it cannot hear yet.
  void attach_to(dds_entity_t wait_set);
  /// Looks at the writers that were discovered since the last call: creates the second reader where
  /// it is needed and was not created yet, and warns, once, of a writer that neither can hear.
  void meet_writers();

 private:
  struct Endpoint {
    Entity reader;
    Entity has_samples;  // read condition
  };

  Endpoint make_endpoint(bool transient_local) const;
  void attach(dds_entity_t wait_set, const Endpoint& endpoint) const;
  /// One loan's worth; returns how many were removed, those that are skipped included.
  std::size_t take_some(const Endpoint& endpoint, std::size_t max, const Visit& visit,
                        const Ended& ended);
  /// Whether the writer keeps history, so that the first reader hears it too. False for one that is
  /// gone: a sample twice is better than none.
  bool is_heard_by_first(dds_instance_handle_t writer);
  /// Takes until nothing came for `quiet`, or until `limit` has passed.
  std::size_t take_until_quiet(dds_duration_t quiet, dds_duration_t limit, const Visit& visit);
  /// A topic without history: the first reader matches every writer.
  bool is_volatile() const { return profile_.history != keep_all && profile_.late_joiners == 0; }
  /// Whether a full reader makes writers, and the middleware's thread, wait.
  bool is_bounded() const { return profile_.history == keep_all && options_.keep_last == 0; }

  Participant& participant_;
  const SharedSession session_;
  const Profile& profile_;
  ReaderOptions options_;
  PublicationWatch publications_;
  bool warned_of_best_effort_ = false;
  Entity topic_;
  Endpoint first_;
  Endpoint second_;                                      // empty until a volatile writer is there
  std::map<dds_instance_handle_t, bool> keeps_history_;  // writers that the second reader met
  std::vector<dds_entity_t> wait_sets_;
};

}  // namespace reident::dds
