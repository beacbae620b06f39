// What changes while the page is open: heartbeats of services on DDS, and what is decided in the
// registry. Kept by key, so that a viewer who does not read gets the newest state and no backlog.
#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "service/dds/dds.hpp"
#include "service/support/mutex.hpp"
#include "service/web/http_server.hpp"
#include "service/web/json.hpp"

namespace reident::web {

/// A service's last heartbeat.
struct HeardStatus {
  ServiceStatus status;
  std::chrono::steady_clock::time_point heard;

  /// Heartbeats come each second.
  bool is_fresh() const {
    return std::chrono::steady_clock::now() - heard <= std::chrono::seconds(5);
  }
};

/// Decisions so far, by kind and whether the gate made them.
using DecisionCounts = std::map<std::pair<std::string, bool>, std::uint64_t>;

/// The state of a service as JSON, with the seconds since its last heartbeat.
Json status_value(const HeardStatus& heard);

class LiveState final : public EventSource {
 public:
  /// Hears the services of the endpoint, and looks into the database, which may not be there yet.
  /// Throws dds::Error.
  LiveState(const dds::Endpoint& endpoint, std::filesystem::path database);

  /// The thread's body: until stop(). `changed` is called after each change.
  void run(const std::function<void()>& changed);
  void stop();

  /// The services that were heard, by name.
  std::map<std::string, HeardStatus> services() const;
  /// Why the registry could not be read when it was looked into last; empty where it could.
  std::string database_error() const;
  DecisionCounts decisions() const;

  Events since(std::uint64_t revision) override;
  /// As since(), as JSON for those who poll.
  Json changes_since(std::uint64_t revision) const;

 private:
  struct Entry {
    std::uint64_t revision = 0;
    std::uint64_t changes = 0;  // of this key
    std::string event;          // what kind of thing the key is
    Json value;
  };

  bool put(const std::string& key, const std::string& event, const Json& value)
      REIDENT_REQUIRES(mutex_);
  /// Who hears of a heartbeat late hears how old it is by then.
  Json value_now(const Entry& entry) const REIDENT_REQUIRES(mutex_);
  bool take_statuses();
  bool look_into_registry();

  dds::Participant participant_;
  dds::Reader<ServiceStatus> statuses_;
  dds::Reader<ModelVersion> versions_;  // a published version shows that something was decided
  dds::WaitSet ready_;
  const std::filesystem::path database_;
  std::atomic<bool> stopping_ = false;
  mutable Mutex mutex_;
  std::uint64_t revision_ REIDENT_GUARDED_BY(mutex_) = 0;
  std::uint64_t changes_ REIDENT_GUARDED_BY(mutex_) = 0;
  std::map<std::string, Entry> entries_ REIDENT_GUARDED_BY(mutex_);
  std::map<std::string, HeardStatus> services_ REIDENT_GUARDED_BY(mutex_);
  std::string database_error_ REIDENT_GUARDED_BY(mutex_);
  DecisionCounts decisions_ REIDENT_GUARDED_BY(mutex_);
  std::int64_t counted_ = 0;  // id of the last decision among them
};

}  // namespace reident::web
