// What kinds of writers of a topic there are in a partition, whether a reader matches them or not.
#pragma once

#include <string>

#include "service/dds/session.hpp"

namespace reident::dds {

/// Follows the middleware's own topic of publications, which has every writer of the domain. The
/// status of incompatible QoS that a reader can be asked for would not do: it keeps the policy of
/// the last writer alone, and does not separate writers of other partitions from those of its own.
/// One thread at a time. The session has to outlive it.
class PublicationWatch {
 public:
  /// Watches writers of `topic` in the session's partition. Throws Error.
  PublicationWatch(const Session& session, std::string topic);

  /// Writers that a RELIABLE, TRANSIENT_LOCAL reader of the partition does not match.
  struct Unmatched {
    bool best_effort = false;        // some offer BEST_EFFORT
    bool reliable_volatile = false;  // some are RELIABLE and VOLATILE
  };
  /// Looks at the writers that were discovered since the last call, also at those that were there
  /// before this object. Throws Error.
  Unmatched take();

  /// A condition that is true while take() has something to look at, for wait sets.
  dds_entity_t has_publications() const { return has_publications_.get(); }

 private:
  /// Adds to `unmatched` what the writer is, where it is one of the topic and the partition.
  void look_at(const dds_builtintopic_endpoint_t& writer, Unmatched& unmatched) const;
  /// Whether one of the writer's partitions matches; names may be patterns, as in the middleware.
  bool is_in_partition(const dds_qos_t* qos) const;

  std::string topic_;
  std::string partition_;
  Entity publications_;
  Entity has_publications_;
};

}  // namespace reident::dds
