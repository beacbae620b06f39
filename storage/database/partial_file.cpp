#include "storage/database/partial_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <unistd.h>

#include <sys/file.h>
#include <sys/stat.h>

#include "storage/database/database.hpp"

namespace reident::storage {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what,
                       int system_error) {
  using Kind = Error::Kind;
  const bool full = system_error == ENOSPC || system_error == EDQUOT || system_error == EFBIG;
  const bool denied = system_error == EACCES || system_error == EROFS || system_error == EPERM;
  const std::string remedy = full     ? "free space on its disk or raise the quota"
                             : denied ? "check the permissions of its folder"
                                      : "check the path and the disk";
  throw Error(full     ? Kind::full
              : denied ? Kind::read_only
                       : Kind::cannot_open,
              "file " + file.string() + " cannot be " + what + " (" + std::strerror(system_error) +
                  "): " + remedy);
}

[[noreturn]] void refuse_busy(const std::filesystem::path& file) {
  throw Error(Error::Kind::locked,
              "file " + file.string() + " is being written by another process: wait for it");
}

bool is_at(int descriptor, const std::filesystem::path& path) {
  struct stat open {
  }, named{};
  return ::fstat(descriptor, &open) == 0 && ::stat(path.c_str(), &named) == 0 &&
         open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

bool take_name(const std::filesystem::path& from, const std::filesystem::path& to, bool replace) {
  if (!replace) {
    if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0)
      return true;
    if (errno != EINVAL && errno != ENOSYS) return false;
    // A file system without it: the name was free when this began.
  }
  return ::rename(from.c_str(), to.c_str()) == 0;
}

// EINVAL: a file system whose folders need no flush.
void flush_folder(const std::filesystem::path& folder, const std::filesystem::path& entry) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool flushed = descriptor >= 0 && ::fsync(descriptor) == 0;
  const int system_error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!flushed && system_error != EINVAL) fail(entry, "forced to the disk", system_error);
}

}  // namespace

mode_t permissions_of(const std::filesystem::path& file) {
  struct stat status {};
  return ::stat(file.c_str(), &status) == 0 ? (status.st_mode & 0777U) | 0600U : 0600U;
}

void make_folder_of(const std::filesystem::path& file, const std::filesystem::path& like) {
  const std::filesystem::path folder = file.parent_path();
  std::error_code error;
  if (std::filesystem::create_directory(folder, like, error)) flush_folder(like, folder);
  if (error) fail(folder, "made", error.value());
}

PartialFile::PartialFile(const std::filesystem::path& target, mode_t mode)
    : target_(target), path_(target.string() + ".partial") {
  // The second time what was left is gone; it is there again only if another process made it.
  if (make(mode)) return;
  remove_what_was_left();
  if (!make(mode)) refuse_busy(path_);
}

// False where there is such a file.
bool PartialFile::make(mode_t mode) {
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (descriptor_ < 0) {
    if (errno == EEXIST) return false;
    fail(path_, "made", errno);
  }
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return true;
  ::close(descriptor_);
  refuse_busy(path_);
}

// The lock distinguishes a file that is being written from one that was left. Between open and lock
// the file may have taken its target's name: then it is another's, and whole.
void PartialFile::remove_what_was_left() {
  const int left = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (left < 0) {
    if (errno == ENOENT) return;
    fail(path_, "replaced", errno);
  }
  const bool ours = ::flock(left, LOCK_EX | LOCK_NB) == 0 && is_at(left, path_);
  const int system_error = ours && ::unlink(path_.c_str()) != 0 ? errno : 0;
  ::close(left);
  if (!ours) refuse_busy(path_);
  if (system_error != 0) fail(path_, "replaced", system_error);
}

PartialFile::~PartialFile() {
  if (!published_) ::unlink(path_.c_str());
  ::close(descriptor_);
}

void PartialFile::publish(bool replace) {
  if (::fsync(descriptor_) != 0) fail(path_, "written", errno);
  if (!take_name(path_, target_, replace))
    fail(path_, "renamed to " + target_.filename().string(), errno);
  published_ = true;
  flush_folder(target_.parent_path(), target_);
}

}  // namespace reident::storage
