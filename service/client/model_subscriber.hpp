// The approved models of a spacecraft's equipment, as they are published and once they are checked.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "service/dds/dds.hpp"
#include "service/model/messages.hpp"
#include "service/model/model_version.hpp"

namespace reident {

struct Subscription {
  std::string simulator;  // unique name; acknowledgements carry it
  std::string spacecraft;
  std::vector<std::string> equipment;  // empty: every equipment of the spacecraft
};

/// Hands each approved version over once, checked, and tells the service what becomes of it. A
/// version that is damaged, unstable, or older than the one in use without being a rollback is
/// refused; the one in use stays. It also stays when the service disposes of it, ends or dies.
class ModelSubscriber {
 public:
  struct Refusal {
    std::string equipment;
    std::int64_t version = 0;
    std::string reason;
  };
  using Adopt = std::function<void(const ModelVersion&)>;
  using Refuse = std::function<void(const Refusal&)>;

  /// The participant must outlive it. Throws dds::Error.
  ModelSubscriber(dds::Participant& participant, Subscription subscription);

  void attach_to(dds::WaitSet& wait_set);
  /// Takes what was published since the last call: `adopt` for each version to be run from now on,
  /// `refuse` for each that must not be. Returns how many were adopted. Refusals are acknowledged
  /// as such; it is the caller's to acknowledge what it runs.
  std::size_t poll(const Adopt& adopt, const Refuse& refuse);
  /// Tells the service that the version in use of `equipment` runs since `since`, with what error.
  void acknowledge(const std::string& equipment, storage::Time since, double running_mrse_percent);

  /// The version in use of an equipment; null where none came yet.
  const ModelVersion* in_use(const std::string& equipment) const;

 private:
  bool is_wanted(const EquipmentModel& model) const;
  void consider(ModelVersion&& version, const Adopt& adopt, const Refuse& refuse);
  void refuse_version(const ModelVersion& version, const std::string& reason, const Refuse& refuse);

  Subscription subscription_;
  dds::Reader<ModelVersion> versions_;
  dds::Writer<ModelAcknowledgement> acknowledgements_;
  std::map<std::string, ModelVersion> in_use_;  // by equipment
};

}  // namespace reident
