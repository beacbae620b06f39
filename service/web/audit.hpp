// What was refused to whom: the last so many, and all of them in a file where one is named.
#pragma once

#include <deque>
#include <filesystem>
#include <fstream>
#include <string>

#include "service/support/mutex.hpp"
#include "service/web/json.hpp"

namespace reident::web {

/// One refusal. Texts are as they came.
struct Refused {
  std::string code{};  // of the answer
  std::string user{};  // empty: nobody known
  std::string peer{};
  std::string action{}, spacecraft{}, equipment{}, version{};
};

/// Any thread may call it.
class Audit {
 public:
  /// `file` gets a JSON object a line; empty: none. Throws std::runtime_error where it cannot be
  /// written.
  explicit Audit(const std::filesystem::path& file);

  void add(const Refused& refused, storage::Time time);
  /// The newest first.
  Json last() const;

 private:
  mutable Mutex mutex_;
  std::ofstream file_ REIDENT_GUARDED_BY(mutex_);
  std::deque<Json> last_ REIDENT_GUARDED_BY(mutex_);
};

}  // namespace reident::web
