#include "service/support/output_file.hpp"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <stdexcept>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace reident {
namespace {

constexpr mode_t permissions = 0666;  // less the umask

}  // namespace

OutputFile::OutputFile(std::filesystem::path path, Existing existing)
    : path_(std::move(path)), existing_(existing) {
  std::error_code failed;
  if (std::filesystem::is_directory(*path_, failed))
    throw std::runtime_error(path_->string() + " is a folder: name a file in it");
  if (std::filesystem::exists(*path_, failed) && !std::filesystem::is_regular_file(*path_, failed))
    throw std::runtime_error(path_->string() +
                             " is no regular file, and would be replaced by one: "
                             "write to standard output instead");
  descriptor_ = ::open(part().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, permissions);
  if (descriptor_ < 0) fail(errno);
}

OutputFile OutputFile::standard_output() {
  OutputFile output;
  output.descriptor_ = STDOUT_FILENO;
  return output;
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::exchange(other.path_, std::nullopt)),
      existing_(other.existing_),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputFile::~OutputFile() {
  if (!path_ || descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(part().c_str());
}

std::filesystem::path OutputFile::part() const {
  return path_->string() + ".part";
}

void OutputFile::fail(int code) const {
  if (code == EPIPE)
    throw std::runtime_error("the reader of the output went away before it was complete");
  const std::string name = path_ ? path_->string() : "standard output";
  const std::string reason = std::generic_category().message(code);
  if (code == ENOSPC || code == EDQUOT || code == EFBIG)
    throw std::runtime_error(name + " cannot be written, there is no room (" + reason +
                             "): make room or name a file on another disk");
  throw std::runtime_error(name + " cannot be written: " + reason +
                           "; check the path and its permissions");
}

void OutputFile::write(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

bool OutputFile::take_name() const {
  if (existing_ == Existing::kept) {
    if (::renameat2(AT_FDCWD, part().c_str(), AT_FDCWD, path_->c_str(), RENAME_NOREPLACE) == 0)
      return true;
    if (errno != EINVAL && errno != ENOSYS) return false;
    // A file system without it.
    if (::access(path_->c_str(), F_OK) == 0) {
      errno = EEXIST;
      return false;
    }
  }
  return ::rename(part().c_str(), path_->c_str()) == 0;
}

void OutputFile::finish() {
  if (!path_) return;
  if (::fsync(descriptor_) != 0) fail(errno);
  if (!take_name()) fail(errno);
  ::close(std::exchange(descriptor_, -1));
}

}  // namespace reident
