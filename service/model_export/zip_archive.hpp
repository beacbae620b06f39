// A zip file in memory.
#pragma once

#include <deque>
#include <string>

struct zip;
struct zip_source;

namespace reident::model_export {

/// Entries carry no time, so that the same entries give the same bytes. Calls throw
/// std::runtime_error where the library fails.
class ZipArchive {
 public:
  ZipArchive();
  ~ZipArchive();
  ZipArchive(const ZipArchive&) = delete;
  ZipArchive& operator=(const ZipArchive&) = delete;

  void add(const std::string& path, std::string content);
  /// The bytes of the whole file; nothing can be added afterwards.
  std::string finish();

 private:
  [[noreturn]] void fail(const std::string& what) const;

  std::deque<std::string> contents_;  // the library reads them when it closes the archive
  zip_source* file_ = nullptr;
  zip* archive_ = nullptr;
};

}  // namespace reident::model_export
