// How the process's allocator treats what is freed.
#pragma once

namespace reident {

/// Keeps freed memory up to 256 MiB instead of giving it back to the system, so that a refresh does
/// not take the same pages again each time. Blocks of 32 MiB and more still go back at once. Call
/// once, before threads start.
void keep_freed_memory();

/// Gives back what is kept now; for a moment when much was freed that will not be needed soon. Any
/// thread may call it.
void return_freed_memory();

}  // namespace reident
