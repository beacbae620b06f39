#include "service/support/program_identity.hpp"

#include <array>
#include <unistd.h>

#include <fmt/format.h>

#include "service/support/utc_clock.hpp"

namespace reident {

std::string unique_program_name(std::string_view program) {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  return fmt::format("{}:{:.100}:{}:{}", program, host.data(), ::getpid(), utc_now());
}

}  // namespace reident
