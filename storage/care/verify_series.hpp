// The part of verify that looks at one series: its chunks, fragments and gaps. Private to
// storage.
#pragma once

#include <bitset>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "storage/archive/chunk_bytes.hpp"
#include "storage/care/verify.hpp"
#include "storage/chunks/chunk.hpp"
#include "storage/chunks/sample_gaps.hpp"
#include "storage/database/sqlite.hpp"
#include "storage/types/sample_columns.hpp"

namespace reident::storage {

/// Which rows of chunk_data in the database itself chunks refer to, by id: a bit each. A damaged id
/// may be any number.
class DataReferences {
 public:
  void add(std::int64_t id);
  bool has(std::int64_t id) const;
  /// Those that were added twice.
  const std::set<std::int64_t>& repeated() const { return repeated_; }

 private:
  static constexpr int block_bits = 16;
  static constexpr std::size_t block = std::size_t{1} << block_bits;
  std::unordered_map<std::int64_t, std::bitset<block>> seen_;
  std::set<std::int64_t> repeated_;
};

/// One thread at a time; keeps its memory from series to series.
class SeriesVerifier {
 public:
  /// `advanced` gets how many samples were looked at, and says whether to go on.
  SeriesVerifier(sqlite::Connection& connection, const VerifyOptions& options, VerifyReport& report,
                 DataReferences& references, std::function<bool(std::uint64_t)> advanced);

  /// In one snapshot. False when it was stopped.
  bool verify(std::int64_t series);

 private:
  struct Row {
    Time first = 0, last = 0;
    std::uint64_t samples = 0;
    Sampling sampling;
    std::optional<double> least, greatest;
  };
  struct Seen {  // so far, of the series at hand
    std::uint64_t samples = 0;
    std::optional<Time> first, last;
    std::optional<Row> previous;
    std::set<std::int64_t> sources;
    std::vector<SampleGap> gaps;
    bool undecodable = false;
    bool known = false;  // some chunk was not decoded since it is as it was
  };

  bool begin(std::int64_t series);
  void read_recent(std::int64_t series);
  bool read_chunks(std::int64_t series);
  void look_at_chunk(const Row& row, ChunkPlace place);
  /// Whether it need not be decoded.
  bool is_known(const Row& row, std::int64_t key, std::uint64_t digest) const;
  void compare_with_summary(const Row& row, const ChunkSummary& summary);
  void look_at_samples(const Row& row);
  void look_at_values(Time first, Time last);
  void read_revisions(std::int64_t series);
  void compare_series();
  void compare_gaps(std::int64_t series);
  void compare_sources();
  void report_set_aside(std::int64_t series);
  void add(const char* check, std::optional<Time> first, std::optional<Time> last, std::string what,
           const char* remedy);

  sqlite::Connection& connection_;
  const VerifyOptions& options_;
  VerifyReport& report_;
  DataReferences& references_;
  const std::function<bool(std::uint64_t)> advanced_;
  ChunkBytes bytes_;
  ChunkDecoder decoder_;
  SamplingMeter meter_;
  SampleColumns samples_;

  // The series at hand.
  std::string spacecraft_, name_;
  Origin origin_ = Origin::real;
  std::uint64_t count_ = 0;
  std::uint64_t set_aside_ = 0;
  std::optional<Time> first_, last_;
  std::int64_t moved_ = 0;
  std::vector<Time> recent_;  // times in fragments, ascending
  Seen seen_;
};

}  // namespace reident::storage
