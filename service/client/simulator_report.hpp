// What reident-simulator prints on standard output: a line an event, as text or as one JSON object.
// The members of the objects are an interface: scripts and tests read them.
#pragma once

#include <optional>
#include <string>

#include "service/client/live_equipment.hpp"
#include "service/client/model_subscriber.hpp"

namespace reident {

/// Each call prints one line and flushes it.
class SimulatorReport {
 public:
  explicit SimulatorReport(bool json) : json_(json) {}

  /// A version runs now; `swap` where it took over from another one.
  void adopted(const ModelVersion& version, const Arrival& arrival,
               const std::optional<ModelRunner::Swap>& swap) const;
  /// A kept version is the one that the service publishes.
  void confirmed(const storage::EquipmentName& equipment, std::int64_t version) const;
  /// A version was published and is not taken.
  void refused(const ModelSubscriber::Refusal& refusal) const;
  /// No version of the equipment, a name or a pattern, came in time.
  void unpublished(const storage::EquipmentName& equipment, const std::string& text) const;
  /// A file of last good versions could not be read or written.
  void cache_fault(const CacheFault& fault) const;
  /// The errors of a run so far, or what it waits for. `final`: nothing more is said about this
  /// version.
  void running(const storage::EquipmentName& equipment, const LiveEquipment& live,
               bool final) const;

 private:
  bool json_;
};

}  // namespace reident
