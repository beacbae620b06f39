// A file of no disk, for what reads files alone.
#pragma once

#include <cstdlib>
#include <string>
#include <string_view>
#include <unistd.h>

#include <sys/mman.h>

namespace reident::test {

class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("fuzz", 0)) {
    if (descriptor_ < 0) std::abort();
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

  /// The text replaces what was in it.
  void write(std::string_view text) const {
    const auto size = static_cast<ssize_t>(text.size());
    if (ftruncate(descriptor_, 0) != 0 || pwrite(descriptor_, text.data(), text.size(), 0) != size)
      std::abort();
  }

 private:
  int descriptor_;
};

}  // namespace reident::test
