// What the middleware has to say goes into the program's log.
#pragma once

namespace reident::dds {

/// From here on warnings and errors of the middleware are lines of the log. A text that comes again
/// within an hour is counted alone, and its next line has the count: a participant that is not let
/// in tries twice a second, for ever. For programs; a library leaves that to the program that it is
/// in. Any thread may call it.
void log_what_the_middleware_says();

}  // namespace reident::dds
