// Through the chunks of all series from the oldest on, past those that must stay. Private to
// storage.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "storage/archive/chunk_store.hpp"
#include "storage/care/retention.hpp"

namespace reident::storage {

/// Keeps its place from call to call; chunks that come behind it are not seen.
class ChunkWalk {
 public:
  enum class Cause { age, size };
  struct Step {
    ChunkRow row;
    std::uint64_t bytes = 0;
    Cause cause = Cause::age;
  };

  ChunkWalk(sqlite::Connection& connection, const RetentionRule& rule,
            const std::vector<ProtectedRange>& protection, Time now);

  void protect(const std::vector<ProtectedRange>& protection);

  /// Offers `visit` one chunk after the other: first what is too old, then, while `excess` says so,
  /// what is oldest. `excess` is asked before each of these. Where `visit` says no, the walk ends
  /// before that chunk.
  void visit(const std::function<bool()>& excess, const std::function<bool(const Step&)>& visit);

  /// Chunks that were passed over because they are protected.
  std::uint64_t passed() const { return passed_; }

 private:
  struct Place {
    std::int64_t series = 0;
    std::string spacecraft;
    std::uint32_t parameter = 0;
    std::optional<Time> cutoff;     // older chunks go
    std::optional<Time> from;       // chunks that begin earlier were seen; absent when all were
    std::vector<TimeRange> kept{};  // ascending, none touching the next
    std::optional<Step> next{};
  };
  void find_next(Place& place);
  bool is_kept(const Place& place, const ChunkRow& row) const;
  void pass(Place& place);

  sqlite::Connection& connection_;
  std::vector<Place> places_;
  bool by_size_ = false;
  std::uint64_t passed_ = 0;
};

}  // namespace reident::storage
