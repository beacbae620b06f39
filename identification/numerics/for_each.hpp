// How a caller lends its threads: identification starts none, and its results do not depend on
// who runs the tasks.
#pragma once

#include <cstddef>
#include <functional>

namespace reident::identification {

/// Runs task(0), ..., task(count - 1) in any order, on as many threads as it likes, and returns
/// when all are done. Tasks are independent of each other and throw nothing. What the function
/// itself throws passes through.
using ForEach =
    std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

/// Runs the tasks one after the other on the calling thread.
inline void in_sequence(std::size_t count, const std::function<void(std::size_t)>& task) {
  for (std::size_t i = 0; i < count; ++i) task(i);
}

}  // namespace reident::identification
