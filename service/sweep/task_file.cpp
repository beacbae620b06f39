#include "service/sweep/task_file.hpp"

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <system_error>

#include "service/support/output_file.hpp"
#include "service/support/program_identity.hpp"
#include "service/support/sha256.hpp"

namespace reident::sweep {

using nlohmann::ordered_json;

void write_task_file(const std::filesystem::path& file, const ordered_json& result) {
  // "reident:HOST:PID:TIME" is no other process's.
  const std::filesystem::path own = file.string() + "." + unique_program_name("reident");
  const std::string text = result.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  OutputFile output(own);
  output.write(text + "\n" + sha256_hex(text) + "\n");
  output.finish();
  std::error_code failed;
  std::filesystem::rename(own, file, failed);
  if (!failed) return;
  std::error_code ignored;
  std::filesystem::remove(own, ignored);
  throw std::runtime_error(file.string() + " cannot be written: " + failed.message() +
                           "; check the folder and its permissions");
}

std::optional<ordered_json> read_task_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  const std::string content(std::istreambuf_iterator<char>(stream), {});
  const std::size_t end = content.find('\n');
  if (end == std::string::npos) return std::nullopt;
  const std::string text = content.substr(0, end);
  if (content.substr(end + 1) != sha256_hex(text) + "\n") return std::nullopt;
  ordered_json result = ordered_json::parse(text, nullptr, false);
  if (result.is_discarded()) return std::nullopt;
  return result;
}

}  // namespace reident::sweep
