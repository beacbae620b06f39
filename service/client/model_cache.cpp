#include "service/client/model_cache.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <unistd.h>
#include <utility>

#include <sys/file.h>

#include "service/client/cached_version_file.hpp"
#include "service/client/version_check.hpp"
#include "service/support/output_file.hpp"
#include "service/support/sha256.hpp"

namespace reident {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto lock_patience = 1s;
constexpr auto lock_look = 5ms;
// A file name has at most 255: this leaves room for what OutputFile and set_aside() append.
constexpr std::size_t max_name_bytes = 200;
constexpr std::size_t cut_name_bytes = 100;

std::string percent_encoded(const std::string& name) {
  static constexpr char digits[] = "0123456789ABCDEF";
  std::string encoded;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '_';
    if (plain)
      encoded += c;
    else
      encoded.append({'%', digits[byte >> 4U], digits[byte & 0xFU]});
  }
  return encoded;
}

std::string shortened(const std::string& encoded) {
  if (encoded.size() <= max_name_bytes) return encoded;
  return encoded.substr(0, cut_name_bytes) + "~" + sha256_hex(encoded);
}

/// 0 when it is locked, or the file system knows no locks: then two programs that write at once may
/// damage a file, which its SHA-256 shows.
int wait_for_lock(int descriptor) {
  const auto deadline = std::chrono::steady_clock::now() + lock_patience;
  while (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) return 0;
    if (std::chrono::steady_clock::now() > deadline) return EWOULDBLOCK;
    std::this_thread::sleep_for(lock_look);
  }
  return 0;
}

/// A folder that no other program that asks for it works in, for as long as this exists.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder)
      : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)),
        error_(descriptor_ < 0 ? errno : wait_for_lock(descriptor_)) {}
  ~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  int error() const { return error_; }
  /// Has the names of its files on the disk.
  bool flush() const { return ::fsync(descriptor_) == 0; }

 private:
  int descriptor_;
  int error_;
};

std::string lock_fault(const fs::path& folder, int error) {
  if (error == EWOULDBLOCK)
    return folder.string() + " is locked by another program for longer than a second";
  return folder.string() + " cannot be opened: " + std::generic_category().message(error) +
         "; check the path and its permissions";
}

/// What became of it, for the report.
std::string set_aside(const fs::path& file) {
  std::error_code error;
  fs::rename(file, file.string() + ".damaged", error);
  return error ? "it cannot be set aside (" + error.message() + ")" : "set aside as .damaged";
}

std::string about(const fs::path& file, const Unusable& unusable, const FolderLock& lock) {
  const std::string text = file.string() + " is not used: " + unusable.reason;
  if (unusable.kind != Unusable::Kind::damaged || lock.error() != 0) return text;
  return text + "; " + set_aside(file);
}

bool is_as_new(const ModelVersion& there, const ModelVersion& version) {
  return succession(version, there) != Succession::newer;
}

}  // namespace

ModelCache::ModelCache(fs::path folder, std::string partition)
    : folder_(std::move(folder) / shortened(percent_encoded(partition))),
      partition_(std::move(partition)) {}

std::optional<fs::path> ModelCache::default_folder() {
  const auto absolute = [](const char* name) -> std::optional<fs::path> {
    const char* value = std::getenv(name);
    if (value == nullptr || *value != '/') return std::nullopt;
    return value;
  };
  if (const auto cache = absolute("XDG_CACHE_HOME")) return *cache / "reident";
  if (const auto home = absolute("HOME")) return *home / ".cache" / "reident";
  return std::nullopt;
}

fs::path ModelCache::file_of(const storage::EquipmentName& equipment) const {
  return folder_ / (shortened(percent_encoded(equipment.spacecraft) + "," +
                              percent_encoded(equipment.equipment)) +
                    ".json");
}

std::vector<CachedVersion> ModelCache::load(const Report& report) {
  std::vector<CachedVersion> versions;
  std::error_code error;
  if (!fs::exists(folder_, error) && !error) return versions;
  // Files change by renaming alone: they can be read without the lock, but not set aside.
  const FolderLock lock(folder_);
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder_, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".json") files.push_back(entry->path());
  }
  if (error)
    report({{},
            folder_.string() + " cannot be read: " + error.message() +
                "; check the path and its permissions"});
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    auto read = read_kept_version(file, partition_);
    if (auto* kept = std::get_if<CachedVersion>(&read)) {
      const EquipmentModel& model = kept->version.model;
      if (file_of({model.spacecraft, model.equipment}) == file) {
        versions.push_back(std::move(*kept));
        continue;
      }
      read = Unusable{Unusable::Kind::damaged,
                      "it is of " + model.spacecraft + "/" + model.equipment + ", not of its name"};
    }
    report({{}, about(file, std::get<Unusable>(read), lock)});
  }
  return versions;
}

void ModelCache::store(const CachedVersion& kept, const Report& report) {
  const EquipmentModel& model = kept.version.model;
  const storage::EquipmentName equipment{model.spacecraft, model.equipment};
  std::string fault = try_to_store(kept);
  std::string& before = faults_[equipment];
  if (fault == before) return;
  if (!fault.empty()) report({equipment, fault});
  before = std::move(fault);
}

std::string ModelCache::try_to_store(const CachedVersion& kept) const {
  const EquipmentModel& model = kept.version.model;
  const fs::path file = file_of({model.spacecraft, model.equipment});
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error)
    return folder_.string() + " cannot be made: " + error.message() +
           "; make it, or name another folder";
  const FolderLock lock(folder_);
  if (lock.error() != 0) return lock_fault(folder_, lock.error());
  const auto there = read_kept_version(file, partition_);
  if (const auto* other = std::get_if<CachedVersion>(&there)) {
    if (is_as_new(other->version, kept.version)) return {};
  } else if (const auto& unusable = std::get<Unusable>(there);
             unusable.kind == Unusable::Kind::foreign) {
    return file.string() + " is not replaced: " + unusable.reason;
  } else if (unusable.kind == Unusable::Kind::damaged) {
    set_aside(file);
  }
  try {
    OutputFile output(file);
    output.write(kept_version_text(kept, partition_));
    output.finish();
  } catch (const std::runtime_error& failure) {
    return failure.what();
  }
  if (!lock.flush())
    return folder_.string() +
           " cannot be flushed to the disk: " + std::generic_category().message(errno);
  return {};
}

}  // namespace reident
