// What reident-simulator prints: a line an event, as text or as one JSON object.
#pragma once

#include <optional>
#include <string>

#include "service/client/live_equipment.hpp"
#include "service/client/model_subscriber.hpp"

namespace reident {

class SimulatorReport {
 public:
  explicit SimulatorReport(bool json) : json_(json) {}

  void adopted(const ModelVersion& version, const Arrival& arrival,
               const std::optional<ModelRunner::Swap>& swap) const;
  /// A kept version is the one that the service publishes.
  void confirmed(const storage::EquipmentName& equipment, std::int64_t version) const;
  void refused(const ModelSubscriber::Refusal& refusal) const;
  void cache_fault(const CacheFault& fault) const;
  /// `final`: nothing more is said about this version.
  void running(const storage::EquipmentName& equipment, const LiveEquipment& live,
               bool final) const;

 private:
  bool json_;
};

}  // namespace reident
