// What a thread does that a step must not: allocations and system calls, counted.
#pragma once

#include <cstdint>

namespace reident::bench {

/// From here on the calling thread's calls of malloc and its relatives, free included, are counted,
/// and each of its system calls is refused and counted, to the end of the process: the thread must
/// not end. Other threads go on as before.
void watch_this_thread();

std::uint64_t allocations();
std::uint64_t system_calls();

}  // namespace reident::bench
