// Versions on probation are looked at as telemetry comes, not only when the next window is tried.
#pragma once

#include <string>
#include <vector>

#include "service/daemon/window_attempt.hpp"

namespace reident {

class ConfirmationWatch {
 public:
  /// The configuration must outlive the watch.
  explicit ConfirmationWatch(const Config& config);

  /// Looks at those of every equipment, until `context.stop` answers true. The feed's newest
  /// telemetry, of the time `settle`, is left out. An archive that cannot be read is logged, and
  /// looked at again the next time.
  void look(const storage::Archive& archive, const storage::Registry& registry,
            const WindowFeed& feed, const AttemptContext& context);

 private:
  struct Watched {
    const std::string* spacecraft;
    const EquipmentConfig* equipment;
    storage::Time since = INT64_MIN;  // looked at so far, on this decision state
    storage::DecisionState state{};
  };
  void look(Watched& watched, storage::Time reached, const storage::Archive& archive,
            const storage::Registry& registry, const AttemptContext& context);

  const Duration settle_;
  std::vector<Watched> watched_;  // in the configuration's order
  std::string last_error_;        // said once, not at each look
};

}  // namespace reident
