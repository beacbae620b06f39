// Work that a thread has the archive's thread do without waiting for it: one task at a time.
#pragma once

#include <functional>
#include <future>
#include <string>

#include "service/daemon/archive_writer.hpp"
#include "service/dds/dds.hpp"

namespace reident {

/// Belongs to one thread, which waits on `ready`; both references outlive it.
class PostedTask {
 public:
  using Task = std::function<void(storage::Registry&, storage::Archive&)>;

  PostedTask(ArchiveWriter& writer, dds::WaitSet& ready) : writer_(writer), ready_(ready) {}

  bool is_pending() const { return done_.valid(); }
  /// Where none is pending: has `task` done, and then() by finish().
  void post(Task task, std::function<void()> then);
  /// Calls then() of a task that is done. Returns why it failed; empty where it did not, or is not
  /// done. Throws std::future_error where the archive's thread has ended.
  std::string finish();

 private:
  ArchiveWriter& writer_;
  dds::WaitSet& ready_;
  std::future<void> done_;
  std::function<void()> then_;
};

}  // namespace reident
