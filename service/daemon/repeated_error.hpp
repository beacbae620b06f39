// An error that comes again at each try is logged once.
#pragma once

#include <string>
#include <utility>

namespace reident {

/// What failed last of one thing that is tried again and again. One thread at a time.
class RepeatedError {
 public:
  /// Whether the error is another one than that of the try before, or follows a success.
  bool is_news(const std::string& error) { return std::exchange(last_, error) != error; }
  void succeeded() { last_.clear(); }

 private:
  std::string last_;
};

}  // namespace reident
