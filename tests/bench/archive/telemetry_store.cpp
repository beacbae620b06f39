#include "tests/bench/archive/telemetry_store.hpp"

#include "tests/bench/archive/plain_store.hpp"

namespace reident::bench {
namespace {

using storage::Database;

class ArchiveStore : public TelemetryStore {
 public:
  ArchiveStore(const std::filesystem::path& file, Access access)
      : database_(file,
                  access == Access::read ? Database::Mode::read_only : Database::Mode::read_write),
        archive_(database_) {}

  void describe(std::span<const storage::ParameterDescriptor> descriptors) override {
    archive_.describe(descriptors);
  }
  void append(std::span<const storage::TelemetryFrame> frames) override { archive_.append(frames); }
  void settle() override { archive_.compact(); }

  void load(const MissionTelemetry& telemetry, std::uint64_t first, std::uint64_t count) override {
    constexpr std::uint64_t batch = 512;
    std::vector<storage::TelemetryFrame> frames;
    for (std::uint64_t k = first; k < first + count; k += batch) {
      frames.resize(std::min(batch, first + count - k));
      for (std::size_t i = 0; i < frames.size(); ++i) telemetry.fill(k + i, mission, frames[i]);
      archive_.append(frames);
    }
    settle();
  }

  void read(std::uint32_t parameter, storage::TimeRange range,
            storage::Series& series) const override {
    series = archive_.read(mission, storage::Origin::real, parameter, range);
  }

  std::optional<storage::TimeRange> extent() const override {
    return archive_.extent(mission, storage::Origin::real);
  }

 private:
  Database database_;
  storage::Archive archive_;
};

}  // namespace

std::unique_ptr<TelemetryStore> open_store(StoreKind kind, const std::filesystem::path& file,
                                           Access access) {
  if (kind == StoreKind::plain) return std::make_unique<PlainStore>(file, access);
  return std::make_unique<ArchiveStore>(file, access);
}

std::int64_t bytes_in_use(const std::filesystem::path& file) {
  const SqliteHandle handle = open_sqlite(file, SQLITE_OPEN_READONLY);
  const auto pragma = [&](const std::string& name) {
    const SqliteStatement query = prepare(handle, "PRAGMA " + name);
    check(handle.get(), sqlite3_step(query.get()));
    return sqlite3_column_int64(query.get(), 0);
  };
  return (pragma("page_count") - pragma("freelist_count")) * pragma("page_size");
}

}  // namespace reident::bench
