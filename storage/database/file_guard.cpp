#include "storage/database/file_guard.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <string_view>
#include <unistd.h>

#include <sys/stat.h>

#include "storage/database/log_check.hpp"
#include "storage/database/sqlite.hpp"

namespace reident::storage {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view magic = "SQLite format 3";

/// What the first page of a file says of its size.
struct Extent {
  std::uint64_t page_size = 0;
  std::uint64_t pages = 0;
};

/// Absent where no file of SQLite begins so.
std::optional<Extent> extent_of(const sqlite::Connection& connection) {
  std::array<unsigned char, 32> header{};
  const std::size_t there = connection.read_raw(header);
  const std::size_t compared = std::min(there, magic.size());
  if (there == 0 || std::memcmp(header.data(), magic.data(), compared) != 0) return std::nullopt;
  if (there < header.size()) return Extent{.page_size = 512, .pages = 1};  // the least there is
  std::uint64_t page_size = header[16] * 256U + header[17], pages = 0;
  if (page_size == 1) page_size = 65536;
  if (page_size < 512 || !std::has_single_bit(page_size)) return std::nullopt;
  for (std::size_t i = 28; i < 32; ++i) pages = pages * 256 + header[i];
  return Extent{page_size, pages};
}

std::string in_words(std::int64_t size, const Extent& extent) {
  return "it has " + std::to_string(size) + " of " +
         std::to_string(extent.pages * extent.page_size) + " bytes";
}

Error cut_short(const fs::path& database, const std::string& found,
                const std::string& remedy =
                    "restore a backup, or save what can be read with "
                    "'sqlite3 FILE .recover'") {
  return {Error::Kind::corrupt,
          "database " + database.string() + " was cut short: " + found + "; " + remedy};
}

/// A checkpoint that was broken off, or that a reader keeps from its end, may have written the
/// first page and not the last ones; these are in frames of the log behind the `copied` first ones
/// then.
bool log_has_the_rest(const LogContents& log, std::uint64_t pages_there, std::uint32_t copied) {
  if (log.pages == 0) return false;
  const std::uint64_t of_locks = 0x4000'0000 / log.page_size + 1;  // is never written
  for (std::uint64_t page = pages_there + 1; page <= log.pages; ++page) {
    if (page == of_locks) continue;
    const auto held = log.held.find(static_cast<std::uint32_t>(page));
    if (held == log.held.end() || held->second <= copied) return false;
  }
  return true;
}

[[noreturn]] void displaced(const std::string& database, const std::string& file,
                            const char* what) {
  const std::string process = std::to_string(::getpid());
  // What was committed to a log that has lost its name is folded into the file at the end.
  const std::string remedy =
      file == database
          ? "put it back; as long as process " + process + " runs, /proc/" + process + "/fd has it"
          : "stop process " + process + ", which then saves what it has stored, and start it again";
  throw Error(Error::Kind::displaced, "database " + database + " cannot be written: " + file +
                                          " was " + what + " while it was in use; " + remedy);
}

}  // namespace

bool has_content(const fs::path& file) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(file, error);
  return !error && size > 0;
}

void refuse_damaged_files(const sqlite::Connection& connection, const fs::path& database,
                          bool owns_log, Durability durability) {
  const fs::path log = database.string() + "-wal";
  const std::optional<Extent> extent = extent_of(connection);
  if (!extent || has_content(database.string() + "-journal")) return;
  const std::int64_t size = connection.raw_size();
  const std::uint64_t pages_there = static_cast<std::uint64_t>(size) / extent->page_size;
  if (!has_content(log)) {
    if (pages_there < extent->pages) throw cut_short(database, in_words(size, *extent));
    return;
  }
  if (!owns_log) return;
  const LogContents contents = read_log(log);
  if (contents.damage && durability == Durability::power_cut)
    throw Error(Error::Kind::corrupt, "database " + database.string() + " has a damaged log " +
                                          log.string() + ": " + *contents.damage +
                                          "; restore a backup, or give these commits up with "
                                          "'sqlite3 FILE \"PRAGMA wal_checkpoint(TRUNCATE)\"'");
  const bool is_whole = contents.pages > 0 ? log_has_the_rest(contents, pages_there, 0)
                                           : pages_there >= extent->pages;
  if (!is_whole)
    throw cut_short(database,
                    in_words(size, {extent->page_size,
                                    std::max<std::uint64_t>(contents.pages, extent->pages)}) +
                        ", and its log does not have the rest");
}

FileGuard::FileGuard(const fs::path& database) {
  auto file = files_.begin();
  for (const char* suffix : {"", "-wal", "-shm", ".lock"}) {
    struct stat found {};
    file->path = database.string() + suffix;
    if (::stat(file->path.c_str(), &found) == 0) {
      file->device = found.st_dev;
      file->inode = found.st_ino;
    }
    ++file;
  }
}

void FileGuard::check(sqlite::Connection& connection) {
  for (const File& file : files_) {
    struct stat found {};
    if (::stat(file.path.c_str(), &found) != 0)
      displaced(files_[0].path, file.path, "deleted or moved");
    if (found.st_dev != file.device || found.st_ino != file.inode)
      displaced(files_[0].path, file.path, "replaced by another file");
  }
  const std::optional<Extent> extent = extent_of(connection);
  if (!extent) {
    connection.keep_log();
    throw cut_short(files_[0].path, "it has lost its first page while it is in use");
  }
  // Before the size: SQLite counts frames once they are in the file.
  const std::uint32_t copied = connection.copied_frames();
  const std::int64_t size = connection.raw_size();
  const Short found{static_cast<std::uint64_t>(size) / extent->page_size, copied};
  if (found.pages >= extent->pages) {
    held_.reset();
    return;
  }
  if (found == held_) return;
  const LogContents log = read_log(files_[1].path);
  if (log_has_the_rest(log, found.pages, copied)) {
    held_ = found;
    return;
  }
  connection.keep_log();
  const std::string lengths = in_words(size, *extent) + " while it is in use";
  throw log_has_the_rest(log, found.pages, 0)
      ? cut_short(files_[0].path, lengths,
                  "its log has the rest: stop process " + std::to_string(::getpid()) +
                      " and whatever else has the database open, and start it again")
      : cut_short(files_[0].path, lengths);
}

}  // namespace reident::storage
