// What a program calls itself towards others.
#pragma once

#include <string>
#include <string_view>

namespace reident {

/// Returns the name of this machine, as `hostname` prints it; empty where it has none.
std::string host_name();

/// Returns "PROGRAM:HOST:PID:TIME": like no other's of any process on any machine, at any time, and
/// another at each call. It is a name of idl/README.md, at most 255 bytes, where `program` has at
/// most 100.
std::string unique_program_name(std::string_view program);

}  // namespace reident
