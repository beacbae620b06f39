// Everything that the service says by itself: approved versions, a report of every attempt, its
// heartbeat.
#pragma once

#include <functional>
#include <map>
#include <optional>

#include "service/dds/dds.hpp"
#include "service/support/mutex.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// Any thread may call it.
class Publisher {
 public:
  /// Answers, once a decision is in the registry, whether it may be published; may wait.
  using MayPublish = std::function<bool(const storage::Registry& registry)>;

  /// Throws dds::Error, as every call does. Without `may_publish` every decision may.
  explicit Publisher(dds::Participant& participant, MayPublish may_publish = {});

  /// Publishes what the registry says now about an equipment: its champion, if that was not
  /// published yet, or that there is none. Whoever decided calls it afterwards; of several at a
  /// time the last one publishes the last decision. A model that does not match its digest is not
  /// published, which is logged; returns false.
  bool publish_champion(const storage::Registry& registry, const storage::EquipmentName& equipment);
  /// Publishes every champion, for simulators that start after the service. Returns how many. With
  /// `may_replace_newer` also where it was published before, and so that it runs in simulators that
  /// have a higher number: of a service of the pair that is overruled.
  std::size_t publish_champions(const storage::Registry& registry, bool may_replace_newer = false);
  /// Takes back what was published: simulators that start now get it no more, those that run keep
  /// it.
  void retire();

  /// The versions that are published.
  std::map<storage::EquipmentName, std::int64_t> published() const;

  void report(const IdentificationReport& report) {
    const MutexLock lock(reports_mutex_);
    reports_.write(report);
  }
  /// One thread's.
  void status(const ServiceStatus& status) { status_.write(status); }

 private:
  bool write(const storage::Version& version, const storage::Decision& decision,
             bool follows_a_newer_one) REIDENT_REQUIRES(versions_mutex_);
  bool publish(const storage::Registry& registry, const storage::EquipmentName& equipment,
               bool may_replace_newer) REIDENT_REQUIRES(versions_mutex_);

  dds::Writer<ModelVersion>& versions() REIDENT_REQUIRES(versions_mutex_);

  struct Published {
    std::int64_t decision = 0;  // id of the one that made it champion
    std::int64_t version = 0;
  };
  dds::Participant& participant_;
  const MayPublish may_publish_;
  mutable Mutex versions_mutex_;
  std::optional<dds::Writer<ModelVersion>> versions_ REIDENT_GUARDED_BY(versions_mutex_);
  std::map<storage::EquipmentName, Published> published_ REIDENT_GUARDED_BY(versions_mutex_);
  Mutex reports_mutex_;
  dds::Writer<IdentificationReport> reports_ REIDENT_GUARDED_BY(reports_mutex_);
  dds::Writer<ServiceStatus> status_;
};

}  // namespace reident
