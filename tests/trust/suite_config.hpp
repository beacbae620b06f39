// The configuration of the service under test.
#pragma once

#include <filesystem>

#include "service/daemon/config.hpp"

namespace reident::trust {

/// That of the suite (trust.toml). Throws std::runtime_error with the first mistake in the file.
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
