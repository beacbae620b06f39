// Late samples whose chunk is in a shard that cannot be read. Private to storage.
//
// Nobody knows what the chunk holds at their times, so they wait in the table `postponed_sample`
// until the shard is back. The table is made with the first of them: few archives ever have it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "storage/archive/chunk_bytes.hpp"
#include "storage/database/sqlite.hpp"
#include "storage/types/sample_columns.hpp"

namespace reident::storage {

struct PostponedSample {
  std::int64_t series = 0;
  Time time = 0;
  Held sample;
  bool is_numbered = false;  // its frame was
  /// It was compared with what the chunk holds, and counted, before the shard was lost.
  bool is_settled = false;
};

/// How many samples of a series wait that were counted before the shard was lost.
std::uint64_t settled_and_postponed(sqlite::Connection& connection, std::int64_t series);

class PostponedSamples {
 public:
  /// Within a transaction of the caller, as all that follows. Those that wait are due.
  explicit PostponedSamples(sqlite::Connection& connection);

  void add(const PostponedSample& sample, const ShardError& why);
  /// Those that wait now are due.
  void try_again();
  /// Removes the oldest of those that are due from the table, and gives them to `store`. None is
  /// due any more where it adds one again: its shard is not back, and the next try begins with
  /// others.
  void take(std::size_t most, const std::function<void(std::vector<PostponedSample>&&)>& store);
  /// Those of a source that is removed.
  void forget(std::int64_t source);

  bool is_due() const { return due_ > 0; }
  /// Which shard samples wait for, and the remedy. Empty while none does.
  std::string reason();

 private:
  bool are_waiting();

  sqlite::Connection& connection_;
  bool has_table_ = false;
  std::int64_t due_ = 0;  // id of the last one that is
  std::uint64_t added_ = 0;
  std::string reason_;
};

}  // namespace reident::storage
