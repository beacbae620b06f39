#include "storage/writer_lock.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <unistd.h>

#include <sys/file.h>
#include <sys/stat.h>

#include "storage/database.hpp"

namespace reident::storage {
namespace {

// The pid that the holder wrote; empty in the moment before it did.
std::string holder(int descriptor) {
  std::array<char, 32> text{};
  const ssize_t length = ::pread(descriptor, text.data(), text.size(), 0);
  std::string pid;
  for (ssize_t i = 0; i < length && text[static_cast<std::size_t>(i)] != '\n'; ++i)
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

}  // namespace

WriterLock::WriterLock(const std::filesystem::path& database) {
  const std::filesystem::path file = database.string() + ".lock";
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) cannot_lock(file, errno);
  share_with_owner(descriptor_, database);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const int system_error = errno;
    const std::string who = holder(descriptor_);
    ::close(descriptor_);
    if (system_error != EWOULDBLOCK) cannot_lock(file, system_error);
    throw Error(Error::Kind::locked, "database " + database.string() + " is in use by " + who +
                                         "; stop it or use another database");
  }
  // The pid is for messages alone: the lock holds on a full disk too, where it cannot be written.
  const std::string pid = std::to_string(::getpid()) + "\n";
  if (::pwrite(descriptor_, pid.data(), pid.size(), 0) < 0) return;
}

WriterLock::~WriterLock() {
  ::close(descriptor_);
}

}  // namespace reident::storage
