// The service without middleware and threads: frames in, in the order of their reception, and the
// real archive, windows, identification, gate, registry and leagues behind
// them.
//
// Everything happens on the calling thread. The clock is the reception time of the frame at hand,
// and never goes back; identification takes no time. Frames are committed in batches of ten minutes
// of that clock, so that a decision comes at most so much later than the service's would.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/league_watch.hpp"
#include "service/daemon/window_attempt.hpp"
#include "service/daemon/window_feed.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident::trust {

/// The monitor asked for a window because a champion's errors had grown.
struct DriftRequest {
  std::string equipment;
  storage::Time time = 0;
};

/// One window that was tried.
struct Attempted {
  std::string equipment;
  storage::TimeRange window;
  storage::Time time = 0;
  std::string trigger, outcome, reason;
  std::int64_t version = 0;  // 0 where it gave no model
};

class SimulatedService {
 public:
  /// The database is made in `config.database`, which does not exist. The configuration must
  /// outlive the service.
  explicit SimulatedService(const Config& config);

  void describe(const std::vector<storage::ParameterDescriptor>& descriptors);
  void receive(storage::TelemetryFrame&& frame);
  /// Commits what has come and tries what is due. Nothing may be received afterwards.
  void finish();

  const storage::Registry& registry() const { return registry_; }
  const storage::Archive& archive() const { return archive_; }
  const std::vector<Attempted>& attempts() const { return attempts_; }

 private:
  void commit();
  void try_due_windows();

  const Config& config_;
  storage::Time now_ = INT64_MIN;
  storage::Database database_;
  storage::Archive archive_;
  storage::Registry registry_;
  WindowFeed feed_;
  LeagueWatch leagues_;
  std::vector<WindowCache> kept_;  // by equipment
  AttemptContext context_;
  std::vector<storage::TelemetryFrame> batch_;
  storage::Time batch_began_ = 0;
  std::vector<Attempted> attempts_;
};

}  // namespace reident::trust
