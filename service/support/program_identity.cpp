#include "service/support/program_identity.hpp"

#include <array>
#include <unistd.h>

#include <fmt/format.h>

#include "service/support/utc_clock.hpp"

namespace reident {

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string unique_program_name(std::string_view program) {
  return fmt::format("{}:{:.100}:{}:{}", program, host_name(), ::getpid(), utc_now());
}

}  // namespace reident
