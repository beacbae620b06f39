// The two files that are compared: the archive, and a plain table of samples.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "storage/archive/archive.hpp"
#include "tests/bench/archive/mission_telemetry.hpp"

namespace reident::bench {

class TelemetryStore {
 public:
  virtual ~TelemetryStore() = default;

  virtual void describe(std::span<const storage::ParameterDescriptor> descriptors) = 0;
  /// One transaction, on the disk when it returns.
  virtual void append(std::span<const storage::TelemetryFrame> frames) = 0;
  /// Does the work that append() left for later.
  virtual void settle() = 0;
  /// Appends frames [first, first + count) in whatever order is fastest.
  virtual void load(const MissionTelemetry& telemetry, std::uint64_t first,
                    std::uint64_t count) = 0;
  virtual void read(std::uint32_t parameter, storage::TimeRange range,
                    storage::Series& series) const = 0;
  /// Absent for an empty one.
  virtual std::optional<storage::TimeRange> extent() const = 0;
};

enum class StoreKind { archive, plain };
enum class Access { read, write };

/// The spacecraft whose samples `read` and `extent` mean. The plain table has no column
/// for it.
inline const std::string mission = "MISSION";

/// Creates the file where it does not exist. Both kinds have the same page size, log, checkpoints,
/// cache and durability: what storage/database/database.cpp sets.
std::unique_ptr<TelemetryStore> open_store(StoreKind kind, const std::filesystem::path& file,
                                           Access access);

/// Bytes of the pages that hold something: all tables and indexes, and nothing that was freed.
std::int64_t bytes_in_use(const std::filesystem::path& file);

}  // namespace reident::bench
