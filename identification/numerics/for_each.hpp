#pragma once

#include <cstddef>
#include <functional>

namespace reident::identification {

/// Runs task(0), ..., task(count - 1) in any order, on as many threads as it likes, and returns
/// when all are done.
using ForEach =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

inline void in_sequence(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t i = 0; i < count; ++i) task(i);
}

}  // namespace reident::identification
