// The approved models of equipment, as they are published and once they are checked.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "service/client/model_cache.hpp"
#include "service/dds/dds.hpp"
#include "service/model/messages.hpp"
#include "service/model/model_version.hpp"

namespace reident {

/// Who subscribes, and to what.
struct Subscription {
  std::string simulator;               // unique name; acknowledgements carry it
  std::string spacecraft = "*";        // name, or pattern with * and ? (name_pattern.hpp)
  std::vector<std::string> equipment;  // names or patterns; empty: every equipment
  /// Whether the equipment is subscribed to.
  bool includes(const storage::EquipmentName& name) const;
};

/// How a version came.
struct Arrival {
  storage::Time published = 0;  // when the service sent it, by its clock; 0 where not known
  storage::Time received = 0;   // by this machine's clock; of a kept version, in the earlier run
  bool from_cache = false;      // kept from an earlier run, and not confirmed in this one
};

/// A service publishes at once: who has no version after so long is told so.
inline constexpr std::chrono::seconds version_within{5};

/// Hands each approved version over once, checked, and reports to the service what becomes of it. A
/// version that is damaged, unstable, or older than the newest that was verified without being a
/// rollback is refused. What was verified stays when the service disposes of it, ends or dies.
///
/// Versions that a cache kept from an earlier run come first; what is published then succeeds them
/// as it succeeds one another. One thread at a time. Calls throw dds::Error, and nothing for what
/// the disk does.
class ModelSubscriber {
 public:
  /// A version that is not taken, and why.
  struct Refusal {
    storage::EquipmentName equipment;
    std::int64_t version = 0;
    std::string reason;
  };
  /// What poll() reports; each may be absent.
  struct Listener {
    std::function<void(const ModelVersion&, const Arrival&)> adopt;  // to be run from now on
    std::function<void(const Refusal&)> refuse;                      // must not be run
    /// A kept version turned out to be the one that is published.
    std::function<void(const ModelVersion&, const Arrival&)> confirm;
    ModelCache::Report cache_fault;
  };

  /// The participant must outlive it. Throws dds::Error.
  ModelSubscriber(dds::Participant& participant, Subscription subscription,
                  std::optional<ModelCache> cache = std::nullopt);

  /// Lets the wait set wake for new versions.
  void attach_to(dds::WaitSet& wait_set);
  /// Hands out, at the first call, what was kept, and then what was published since the last call.
  /// Returns how many versions were adopted. Refusals are acknowledged as such; it is the caller's
  /// to acknowledge what it runs. A version is kept in the cache after `adopt` has returned.
  std::size_t poll(const Listener& listener);

  /// Reports to the service what runs of an equipment: a version that was adopted, or none. A
  /// refusal is reported with it until a version of the equipment is verified.
  void acknowledge(const storage::EquipmentName& equipment, const RunningModel& running);

  /// A version that passed every check.
  struct Verified {
    ModelVersion version;
    Arrival arrival;
  };
  /// The newest version of an equipment that was verified; null where none came yet. Valid until
  /// the next poll().
  const Verified* newest(const storage::EquipmentName& equipment) const;
  /// What a simulator is told that after `version_within` has no version of the equipment, or one
  /// that was kept: whether a service is heard in the partition, and where to look.
  std::string unpublished_text(const storage::EquipmentName& equipment) const;

 private:
  struct Told {  // to the service, of one equipment
    RunningModel running;
    std::string running_digest;
    std::optional<Refusal> refusal;
    std::string refused_digest;
  };

  void hand_out_kept(const Listener& listener);
  /// Verifies a version that was received, and adopts, confirms or refuses it.
  void consider(ModelVersion&& version, const Arrival& arrival, const Listener& listener);
  /// Why `version` must not follow `newest`.
  std::string reason_against(const ModelVersion& version, const Verified& newest) const;
  void confirm(Verified& newest, const Arrival& arrival, const Listener& listener);
  void forget_refusal(const storage::EquipmentName& equipment);
  void keep(const Verified& verified, const Listener& listener);
  void refuse(const ModelVersion& version, const std::string& reason, const Listener& listener);
  /// Sends the acknowledgement of an equipment as it stands now.
  void tell(const storage::EquipmentName& equipment);

  const dds::Participant& participant_;
  Subscription subscription_;
  std::optional<ModelCache> cache_;
  bool handed_out_kept_ = false;
  dds::Reader<ModelVersion> versions_;
  dds::Writer<ModelAcknowledgement> acknowledgements_;
  std::map<storage::EquipmentName, Verified> newest_;
  std::map<storage::EquipmentName, Told> told_;
  std::string host_;
};

}  // namespace reident
