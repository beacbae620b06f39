// The writer's own copy of the samples that are in fragments and not yet in chunks: it answers
// what is known already, and gives compaction its work. Private to storage.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "storage/database/sqlite.hpp"
#include "storage/types/sample_columns.hpp"

namespace reident::storage {

/// A series as the writer knows it.
struct SeriesHead {
  struct Fragment {
    std::int64_t batch = 0;
    SampleColumns samples;
  };

  std::int64_t id = 0;
  std::uint64_t samples = 0;  // in chunks and fragments
  std::optional<Time> first{}, last{};
  std::int64_t moved = 0;             // batch up to which its fragments are in chunks
  std::vector<Fragment> fragments{};  // ascending by batch
};

class RecentTier {
 public:
  /// Reads what the file holds, within a transaction of the caller: fragments that cannot be
  /// decoded are set aside. The connection must outlive the tier.
  explicit RecentTier(sqlite::Connection& connection);

  /// Made, in the file too, where it is not known.
  SeriesHead& series(const std::string& spacecraft, Origin origin, std::uint32_t parameter);
  SeriesHead& series(std::int64_t id) { return series_.at(id); }

  /// What a fragment holds at `time`.
  static std::optional<Held> find(const SeriesHead& series, Time time);

  /// Writes fragments of one append, in which no time comes twice. `batch` is next_batch().
  void add(SeriesHead& series, std::int64_t batch, SampleColumns&& samples);
  /// Above every batch in the file. One append may take several in a row.
  std::int64_t next_batch() const { return last_batch_ + 1; }

  /// Samples and batches that wait for compaction, or for their rows to be removed.
  std::size_t samples() const { return samples_; }
  std::size_t batches() const { return rows_.size(); }
  /// Ids of series with fragments, ascending.
  std::vector<std::int64_t> waiting() const;

  /// Fragments of batches up to `batch` are in chunks now.
  void moved(SeriesHead& series, std::int64_t batch);
  /// Removes the rows of the oldest batches up to `batch`, about `rows` of them; every series
  /// moved. False when none is left.
  bool remove_rows(std::int64_t batch, std::size_t rows);

 private:
  using Spacecraft = std::pair<std::string, Origin>;
  void load_series();
  void load_fragments();

  sqlite::Connection& connection_;
  std::unordered_map<std::int64_t, SeriesHead> series_;
  std::map<Spacecraft, std::unordered_map<std::uint32_t, std::int64_t>> ids_;
  std::map<std::int64_t, std::size_t> rows_;  // of each batch in the file
  std::int64_t last_batch_ = 0;
  std::size_t samples_ = 0;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace reident::storage
