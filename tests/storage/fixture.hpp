// What the tests of storage share: a folder of their own, frames in few words, child processes.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/types.h>

#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::storage::test {

/// In memory where the system has a file system there: most tests wait for the disk otherwise.
std::filesystem::path fast_folder();

class TemporaryFolder : public reident::test::TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::filesystem::path& parent = fast_folder())
      : reident::test::TemporaryFolder(parent) {}
};

/// A frame of spacecraft CB4 from source "station"; received when it was generated.
TelemetryFrame frame(std::uint64_t sequence, Time time, std::vector<Sample> samples);

/// Every sample of the archive, read through the archive's own calls.
Series read_all(const Archive& archive, std::uint32_t parameter, Origin origin = Origin::real);

/// What a plain sqlite3 user gets: one string a row, columns separated by '|'.
std::vector<std::string> rows(const std::filesystem::path& database, const std::string& sql);

/// Runs `work` in a child process and returns what it returned, or how the child died.
std::string in_child(const std::function<std::string()>& work);
/// As in_child(), as a user whom file permissions bind (root is not bound by them).
std::string in_unprivileged_child(const std::function<std::string()>& work);

/// "kind: message" of the Error that `work` throws, or what it threw instead, or "no error".
std::string error_of(const std::function<void()>& work);

/// Puts the bytes into a file, in place of what it had.
void write_file(const std::filesystem::path& path, const std::string& bytes);
std::string read_file(const std::filesystem::path& path);

/// A folder and a writable archive in it.
class ArchiveTest : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  std::filesystem::path path = folder / "archive.db";
  Database database{path, Database::Mode::read_write};
  Archive archive{database};

  AppendReport append(const std::vector<TelemetryFrame>& frames) { return archive.append(frames); }
};

}  // namespace reident::storage::test
