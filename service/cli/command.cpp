#include "service/cli/command.hpp"

#include <charconv>
#include <cstdio>

#include <fmt/format.h>

namespace reident::cli {

int refuse(const Refusal& refusal) {
  fmt::print(stderr, "reident: {}\n", refusal.message);
  return exit_impossible;
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

}  // namespace reident::cli
