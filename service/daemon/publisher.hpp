// Everything that the service says: approved versions, a report of every attempt, its heartbeat.
#pragma once

#include "service/dds/dds.hpp"
#include "storage/registry.hpp"

namespace reident {

/// Any thread may call it.
class Publisher {
 public:
  /// Throws dds::Error, as every call does.
  explicit Publisher(dds::Participant& participant);

  /// Publishes a champion as the registry holds it. A model that does not match its digest is not
  /// published; returns false and logs why.
  bool publish(const storage::Version& version, const storage::Decision& decision);
  /// Publishes every champion again, for simulators that start after the service. Returns how many.
  std::size_t publish_champions(const storage::Registry& registry);

  void report(const IdentificationReport& report) { reports_.write(report); }
  void status(const ServiceStatus& status) { status_.write(status); }

 private:
  dds::Writer<ModelVersion> versions_;
  dds::Writer<IdentificationReport> reports_;
  dds::Writer<ServiceStatus> status_;
};

}  // namespace reident
