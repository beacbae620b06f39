#include "service/support/allocator.hpp"

#include <malloc.h>

namespace reident {

void keep_freed_memory() {
  constexpr int mebibyte = 1 << 20;
  mallopt(M_TRIM_THRESHOLD, 256 * mebibyte);
  mallopt(M_MMAP_THRESHOLD, 32 * mebibyte);
}

void return_freed_memory() {
  malloc_trim(0);
}

}  // namespace reident
