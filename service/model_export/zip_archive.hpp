// A zip file in memory.
#pragma once

#include <deque>
#include <string>

struct zip;
struct zip_source;

namespace reident::model_export {

/// Entries carry no time, so that the same entries give the same bytes. The whole file and what
/// goes into it are in memory. Calls throw std::runtime_error where the library fails. One thread
/// at a time.
class ZipArchive {
 public:
  ZipArchive();
  ~ZipArchive();
  ZipArchive(const ZipArchive&) = delete;
  ZipArchive& operator=(const ZipArchive&) = delete;

  /// Adds an entry; paths are UTF-8 with / between folders, each given once.
  void add(const std::string& path, std::string content);
  /// Returns the bytes of the whole file; nothing can be added afterwards. Call once.
  std::string finish();

 private:
  [[noreturn]] void fail(const std::string& what) const;

  std::deque<std::string> contents_;  // the library reads them when it closes the archive
  zip_source* file_ = nullptr;
  zip* archive_ = nullptr;
};

}  // namespace reident::model_export
