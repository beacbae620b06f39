// How all spacecraft of a site are, for a page that was told where their configurations are.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

#include "service/support/mutex.hpp"
#include "service/web/json.hpp"

namespace reident::web {

/// Any thread.
class FleetView {
 public:
  /// `folder`: of the instances' configurations; empty for a page of one service.
  explicit FleetView(std::filesystem::path folder) : folder_(std::move(folder)) {}

  bool is_there() const { return !folder_.empty(); }

  /// The instances, the worst first, as they are now or were a few seconds ago: all who ask have
  /// one reading of the databases. Throws BadRequest where there is no folder, or nothing in it.
  Json view();

 private:
  const std::filesystem::path folder_;
  Mutex mutex_;
  std::optional<Json> read_ REIDENT_GUARDED_BY(mutex_);
  std::chrono::steady_clock::time_point time_ REIDENT_GUARDED_BY(mutex_);
};

}  // namespace reident::web
