#include "service/cli/command.hpp"

#include <charconv>
#include <cstdio>

#include <fmt/format.h>

#include "service/support/terminal.hpp"

namespace reident::cli {

int refuse(const Refusal& refusal) {
  print_error("reident: {}", refusal.message);
  return exit_impossible;
}

CLI::Validator above_zero() {
  return CLI::Validator(
      [](const std::string& text) {
        const auto number = whole_number(text);
        return number && *number > 0 ? std::string()
                                     : fmt::format("{} is no whole number above 0", text);
      },
      "", "above_zero");
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

}  // namespace reident::cli
