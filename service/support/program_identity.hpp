// What a program calls itself towards others.
#pragma once

#include <string>
#include <string_view>

namespace reident {

/// The name of this machine; empty where it has none.
std::string host_name();

/// Begins with `program`; like no other's of any process on any machine, at any time.
std::string unique_program_name(std::string_view program);

}  // namespace reident
