#include "storage/database/writer_lock.hpp"

#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <string_view>
#include <thread>
#include <unistd.h>

#include <sys/file.h>
#include <sys/stat.h>

#include "storage/database/database.hpp"

namespace reident::storage {
namespace {

// The lock file has the pid of its last holder in a line of this many bytes, and behind it a line
// that says that the database has tables. Where a full disk keeps them from being written the lock
// holds all the same.
constexpr std::size_t pid_line = 16;
constexpr std::string_view tables_line = "has tables\n";

bool tells_of_tables(int descriptor) {
  std::array<char, tables_line.size()> text{};
  return ::pread(descriptor, text.data(), text.size(), pid_line) == ssize_t{text.size()} &&
         std::string_view(text.data(), text.size()) == tables_line;
}

// The pid that the holder wrote; empty in the moment before it did.
std::string holder(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t length = ::pread(descriptor, text.data(), text.size(), 0);
  std::string pid;
  for (ssize_t i = 0; i < length && std::isdigit(text[static_cast<std::size_t>(i)]); ++i)
    pid += text[static_cast<std::size_t>(i)];
  return pid.empty() ? "another process" : "process " + pid;
}

[[noreturn]] void cannot_lock(const std::filesystem::path& file, int system_error) {
  const bool denied = system_error == EACCES || system_error == EROFS || system_error == EPERM;
  throw Error(denied ? Error::Kind::read_only : Error::Kind::cannot_open,
              "lock file " + file.string() + " cannot be made (" + std::strerror(system_error) +
                  "): a database that is written needs a folder that can be written; check the "
                  "path and the folder's permissions");
}

// A lock file that root made would keep the database's owner from writing; SQLite does the same for
// its own files.
void share_with_owner(int descriptor, const std::filesystem::path& database) {
  struct stat owner {};
  if (::geteuid() != 0 || ::stat(database.c_str(), &owner) != 0) return;
  if (::fchown(descriptor, owner.st_uid, owner.st_gid) != 0) return;
}

// Whoever asks whether the lock is held shares it for an instant: such a one is waited for.
bool take(int descriptor) {
  constexpr int tries = 1000;
  for (int i = 0; ::flock(descriptor, LOCK_EX | LOCK_NB) != 0; ++i) {
    if (errno != EWOULDBLOCK || i == tries || ::flock(descriptor, LOCK_SH | LOCK_NB) != 0)
      return false;
    ::flock(descriptor, LOCK_UN);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace

WriterLock::WriterLock(const std::filesystem::path& database) {
  const std::filesystem::path file = database.string() + ".lock";
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) cannot_lock(file, errno);
  share_with_owner(descriptor_, database);
  if (!take(descriptor_)) {
    const int system_error = errno;
    const std::string who = holder(descriptor_);
    ::close(descriptor_);
    if (system_error != EWOULDBLOCK) cannot_lock(file, system_error);
    throw Error(Error::Kind::locked, "database " + database.string() + " is in use by " + who +
                                         "; stop it or use another database");
  }
  // Whoever removed the database begins again.
  had_tables_ = std::filesystem::exists(database) && tells_of_tables(descriptor_);
  if (!had_tables_ && ::ftruncate(descriptor_, 0) != 0) {
    const int system_error = errno;
    ::close(descriptor_);
    cannot_lock(file, system_error);
  }
  std::string pid = std::to_string(::getpid());
  pid.resize(pid_line - 1, ' ');
  if (::pwrite(descriptor_, (pid + "\n").data(), pid_line, 0) < 0) return;
}

// The shared lock is held for an instant, which a writer that begins then waits for.
bool WriterLock::is_held(const std::filesystem::path& database) {
  const int descriptor = ::open((database.string() + ".lock").c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool is_free = ::flock(descriptor, LOCK_SH | LOCK_NB) == 0;
  const int system_error = errno;
  ::close(descriptor);
  return !is_free && system_error == EWOULDBLOCK;
}

void WriterLock::note_tables() {
  if (had_tables_) return;
  had_tables_ = ::pwrite(descriptor_, tables_line.data(), tables_line.size(), pid_line) ==
                ssize_t{tables_line.size()};
}

WriterLock::~WriterLock() {
  ::close(descriptor_);
}

}  // namespace reident::storage
