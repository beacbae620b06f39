// The configuration of the service under test.
#pragma once

#include <filesystem>

#include "service/daemon/config.hpp"

namespace reident::trust {

/// Telemetry comes, and is put on the grid, each so often: months at 1 Hz are not affordable.
inline constexpr Duration suite_period = 8'000'000'000;

/// deploy/reference.toml with, for each equipment, the keys
///
///   sample_period = "8s", window = "48000s" (eight orbits), slide = "18000s" (three),
///   validation_share = 0.4, order = [1, 6]
///
/// Throws std::runtime_error with the first mistake in the file.
Config suite_config();

/// A folder of its own, gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace reident::trust
