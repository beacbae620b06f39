// The number of a parameter, from its name.
#pragma once

#include <cstdint>
#include <string_view>

namespace reident::satcs {

/// FNV-1a, 32 bits, of the name: the same parameter has the same id in every file and every run,
/// whatever stands next to it. Two names may collide; who describes parameters checks that
/// (parameter_book.hpp, replay_columns.hpp).
constexpr std::uint32_t parameter_id(std::string_view name) {
  std::uint32_t hash = 2166136261U;
  for (const char c : name) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 16777619U;
  }
  return hash;
}

}  // namespace reident::satcs
