#include "service/support/journal.hpp"

#include <cstdint>
#include <cstdlib>
#include <unistd.h>

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

namespace reident::log {
namespace {

constexpr std::string_view journal_socket = "/run/systemd/journal/socket";

/// NAME, the length of the value in eight bytes, little end first, and the value: it may have line
/// ends.
void append(std::string& entry, std::string_view name, std::string_view value) {
  for (const char c : name) entry += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  entry += '\n';
  for (std::uint64_t size = value.size(), byte = 0; byte < 8; ++byte, size >>= 8)
    entry += static_cast<char>(size & 0xff);
  entry += value;
  entry += '\n';
}

}  // namespace

bool is_stderr_journal() {
  const char* stream = std::getenv("JOURNAL_STREAM");
  struct stat status {};
  return stream != nullptr && fstat(STDERR_FILENO, &status) == 0 &&
         fmt::format("{}:{}", status.st_dev, status.st_ino) == stream;
}

std::string journal_entry(int priority, std::string_view component, std::string_view message,
                          const JournalFields& fields) {
  std::string entry;
  append(entry, "MESSAGE", message);
  append(entry, "PRIORITY", fmt::format("{}", priority));
  append(entry, "COMPONENT", component);
  for (const auto& [name, value] : fields) {
    const std::size_t slash = value.find('/');
    const bool is_equipment = name == "equipment" || (name == "about" && slash != value.npos);
    if (is_equipment && slash != value.npos) append(entry, "SPACECRAFT", value.substr(0, slash));
    append(entry, is_equipment ? "EQUIPMENT" : name == "about" ? "SPACECRAFT" : name, value);
  }
  return entry;
}

bool send_to_journal(const std::string& entry) {
  static const int handle = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  journal_socket.copy(address.sun_path, sizeof(address.sun_path) - 1);
  return sendto(handle, entry.data(), entry.size(), MSG_NOSIGNAL,
                reinterpret_cast<const sockaddr*>(&address), sizeof(address)) >= 0;
}

}  // namespace reident::log
