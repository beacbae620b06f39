#include "tests/bench/archive/telemetry_store.hpp"

#include "tests/bench/archive/plain_store.hpp"

namespace reident::bench {
namespace {

using storage::Database;

class ArchiveStore : public TelemetryStore {
 public:
  ArchiveStore(const std::filesystem::path& file, Access access,
               const std::filesystem::path& extension)
      : database_(file,
                  access == Access::read ? Database::Mode::read_only : Database::Mode::read_write),
        archive_(database_),
        file_(file),
        extension_(extension) {}

  void describe(std::span<const storage::ParameterDescriptor> descriptors) override {
    archive_.describe(descriptors);
  }
  void append(std::span<const storage::TelemetryFrame> frames) override { archive_.append(frames); }
  void settle() override { compact(archive_); }

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

  double average(std::uint32_t parameter, storage::TimeRange range) const override {
    const SqliteHandle handle = open_sqlite(file_, SQLITE_OPEN_READONLY);
    if (!extension_.empty()) {
      sqlite3_db_config(handle.get(), SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION, 1, nullptr);
      check(handle.get(),
            sqlite3_load_extension(handle.get(), extension_.c_str(), nullptr, nullptr));
    }
    const SqliteStatement query =
        prepare(handle,
                "SELECT avg(value) FROM telemetry WHERE spacecraft = ? AND parameter = ? "
                "AND time >= ? AND time < ?");
    const std::string name = "P" + std::to_string(parameter);
    sqlite3_bind_text(query.get(), 1, mission.c_str(), -1, SQLITE_TRANSIENT);
    sqlite3_bind_text(query.get(), 2, name.c_str(), -1, SQLITE_TRANSIENT);
    sqlite3_bind_int64(query.get(), 3, range.begin);
    sqlite3_bind_int64(query.get(), 4, range.end);
    check(handle.get(), sqlite3_step(query.get()));
    return sqlite3_column_double(query.get(), 0);
  }

  std::optional<storage::TimeRange> extent() const override {
    return archive_.extent(mission, storage::Origin::real);
  }

 private:
  template <class A>
  static void compact(A& archive) {
    if constexpr (requires { archive.compact(); }) archive.compact();
  }

  Database database_;
  storage::Archive archive_;
  std::filesystem::path file_;
  std::filesystem::path extension_;
};

}  // namespace

std::unique_ptr<TelemetryStore> open_store(StoreKind kind, const std::filesystem::path& file,
                                           Access access, const std::filesystem::path& extension) {
  if (kind == StoreKind::plain) return std::make_unique<PlainStore>(file, access);
  return std::make_unique<ArchiveStore>(file, access, extension);
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
