// What the archive is compared with: a row for each sample, in the order that reading wants.
#pragma once

#include "tests/bench/archive/plain_sqlite.hpp"
#include "tests/bench/archive/telemetry_store.hpp"

namespace reident::bench {

/// sample(parameter, time, value, quality), PRIMARY KEY (parameter, time), WITHOUT ROWID.
class PlainStore : public TelemetryStore {
 public:
  PlainStore(const std::filesystem::path& file, Access access);

  void describe(std::span<const storage::ParameterDescriptor>) override {}
  void append(std::span<const storage::TelemetryFrame> frames) override;
  void settle() override {}
  void load(const MissionTelemetry& telemetry, std::uint64_t first, std::uint64_t count) override;
  void read(std::uint32_t parameter, storage::TimeRange range,
            storage::Series& series) const override;
  std::optional<storage::TimeRange> extent() const override;

 private:
  void insert(const storage::Sample& sample, storage::Time time);

  SqliteHandle handle_;
  SqliteStatement insert_;
  SqliteStatement range_;
};

}  // namespace reident::bench
