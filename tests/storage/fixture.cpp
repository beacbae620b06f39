#include "tests/storage/fixture.hpp"

#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <unistd.h>

#include <sys/wait.h>

namespace reident::storage::test {
namespace {

constexpr uid_t nobody = 65534;

std::string name(Error::Kind kind) {
  switch (kind) {
    case Error::Kind::cannot_open:
      return "cannot_open";
    case Error::Kind::locked:
      return "locked";
    case Error::Kind::newer_schema:
      return "newer_schema";
    case Error::Kind::older_schema:
      return "older_schema";
    case Error::Kind::corrupt:
      return "corrupt";
    case Error::Kind::full:
      return "full";
    case Error::Kind::read_only:
      return "read_only";
    case Error::Kind::displaced:
      return "displaced";
    case Error::Kind::failed:
      break;
  }
  return "failed";
}

void write_all(int descriptor, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t written = ::write(descriptor, text.data() + done, text.size() - done);
    if (written <= 0) return;
    done += static_cast<std::size_t>(written);
  }
}

std::string read_all_of(int descriptor) {
  std::string text;
  char buffer[4096];
  for (ssize_t length = 0; (length = ::read(descriptor, buffer, sizeof buffer)) > 0;)
    text.append(buffer, static_cast<std::size_t>(length));
  return text;
}

}  // namespace

std::filesystem::path fast_folder() {
  const std::filesystem::path memory = "/dev/shm";
  return ::access(memory.c_str(), W_OK) == 0 ? memory : std::filesystem::temp_directory_path();
}

TelemetryFrame frame(std::uint64_t sequence, Time time, std::vector<Sample> samples) {
  return {.spacecraft = "CB4",
          .source = "station",
          .origin = Origin::real,
          .sequence = sequence,
          .generation_time = time,
          .reception_time = time,
          .samples = std::move(samples)};
}

Series read_all(const Archive& archive, std::uint32_t parameter, Origin origin) {
  return archive.read("CB4", origin, parameter,
                      {std::numeric_limits<Time>::min(), std::numeric_limits<Time>::max()});
}

std::vector<std::string> rows(const std::filesystem::path& database, const std::string& sql) {
  sqlite3* handle = nullptr;
  const int opened = sqlite3_open(database.c_str(), &handle);
  const std::unique_ptr<sqlite3, decltype(&sqlite3_close)> owner(handle, &sqlite3_close);
  if (opened != SQLITE_OK) return {"cannot open"};
  std::vector<std::string> result;
  const auto add_row = [](void* rows, int columns, char** values, char**) {
    std::string row;
    for (int i = 0; i < columns; ++i)
      row += std::string(i ? "|" : "") + (values[i] ? values[i] : "NULL");
    static_cast<std::vector<std::string>*>(rows)->push_back(row);
    return 0;
  };
  if (sqlite3_exec(handle, sql.c_str(), add_row, &result, nullptr) != SQLITE_OK)
    result.push_back(std::string("error: ") + sqlite3_errmsg(handle));
  return result;
}

std::string in_child(const std::function<std::string()>& work) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    std::string answer;
    try {
      answer = work();
    } catch (const std::exception& error) {
      answer = std::string("threw ") + error.what();
    }
    write_all(ends[1], answer);
    ::_exit(0);
  }
  ::close(ends[1]);
  const std::string answer = read_all_of(ends[0]);
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? answer : "died of signal " + std::to_string(WTERMSIG(status));
}

std::string in_unprivileged_child(const std::function<std::string()>& work) {
  return in_child([&]() -> std::string {
    if (::geteuid() == 0 && (::setgid(nobody) != 0 || ::setuid(nobody) != 0))
      return "cannot give up root's rights";
    return work();
  });
}

std::string error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return name(error.kind()) + ": " + error.what();
  } catch (const std::exception& error) {
    return std::string("another exception: ") + error.what();
  }
  return "no error";
}

void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace reident::storage::test
