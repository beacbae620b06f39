// The archive's tables as one statement of the user sees them: series, chunks, recent samples.
//
// All reads happen within the transaction of the user's statement and so see one state of the file.
// Failures are thrown as QueryError.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "storage/chunks/chunk.hpp"
#include "storage/sql/selection.hpp"
#include "storage/sql/shard_files.hpp"
#include "storage/sql/sqlite_api.hpp"
#include "storage/types/sample_columns.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage::sql {

/// Texts at addresses that stay as long as the pool, so that SQLite need not copy them.
class NamePool {
 public:
  std::string_view keep(std::string_view text);

 private:
  std::set<std::string, std::less<>> texts_;
};

struct SeriesName {
  std::int64_t id = 0;
  std::string_view spacecraft;
  std::string_view parameter;  // the descriptor's name, or the id where no descriptor came
  Origin origin = Origin::real;
  std::int64_t moved = 0;  // batches up to this one are in chunks
};

/// A row of the table chunk. No values but NaN where least is above greatest.
struct ChunkEntry {
  Time first_time = 0;
  Time last_time = 0;
  std::uint64_t samples = 0;
  double least = 0;
  double greatest = 0;
  std::int64_t shard = 0, data = 0;  // where its bytes are
};

class ArchiveFile {
 public:
  /// Both must outlive it. Refuses a file that is not an archive of this schema.
  ArchiveFile(sqlite3* connection, NamePool& names);

  /// Series that fit, in the order of their ids.
  std::vector<SeriesName> find(const Selection& selection);

  /// The chunk that holds `time`, else the nearest one on that side.
  std::optional<ChunkEntry> chunk_from(std::int64_t series, Time time);
  std::optional<ChunkEntry> chunk_to(std::int64_t series, Time time);

  /// Appends the samples of a chunk with times within `bounds` to `target`.
  void decode(const SeriesName& series, const ChunkEntry& chunk, TimeBounds bounds,
              const ChunkTarget& target);

  /// Where the fragment lies that starts first within `bounds`, or of those that end in it last.
  std::optional<TimeBounds> next_fragment(const SeriesName& series, TimeBounds bounds,
                                          bool descending);
  /// Lays the recent samples with times within `bounds` over those of chunks.
  void lay_recent_over(SampleColumns& base, const SeriesName& series, TimeBounds bounds,
                       WantedColumns wanted);

  /// Room for a chunk of which a part is taken, kept for the next one.
  SampleColumns scratch;

  /// Name of the source with this id; empty for an unknown one.
  std::string_view source_name(std::int64_t id);

 private:
  struct Fragment {
    std::int64_t batch = 0;
    TimeBounds time;
  };
  const std::vector<Fragment>& fragments(const SeriesName& series);
  [[noreturn]] void fail_damaged(const SeriesName& series, TimeBounds of,
                                 const ChunkError& error) const;
  void refuse_others();
  Statement& prepared(std::unique_ptr<Statement>& statement, std::string_view text);
  void add_series(Statement& rows, const Selection& selection, std::vector<SeriesName>& found);
  std::optional<ChunkEntry> one_chunk(Statement& rows);

  sqlite3* connection_;
  NamePool& names_;
  std::unique_ptr<Statement> all_series_, named_series_, chunk_before_, chunk_after_, bytes_,
      batches_, fragment_, fragment_bytes_, source_;
  std::unordered_map<std::int64_t, std::vector<Fragment>> fragments_;  // by series
  std::unordered_map<std::int64_t, std::string_view> sources_;
  ShardFiles shards_;
  ChunkDecoder decoder_;
};

}  // namespace reident::storage::sql
