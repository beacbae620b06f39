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

  void adopted(const ModelVersion& version, const std::optional<ModelRunner::Swap>& swap) const;
  void refused(const ModelSubscriber::Refusal& refusal) const;
  /// `final`: nothing more is said about this version.
  void running(const std::string& equipment, const LiveEquipment& live, bool final) const;

 private:
  bool json_;
};

}  // namespace reident
