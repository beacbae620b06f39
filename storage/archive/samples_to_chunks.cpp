#include <cmath>
#include <limits>
#include <vector>

#include "storage/archive/archive.hpp"
#include "storage/archive/chunk_store.hpp"
#include "storage/database/migration.hpp"

namespace reident::storage {
namespace {

constexpr std::size_t chunk_samples = ArchiveOptions().chunk_samples;

void put(ChunkStore& chunks, std::int64_t series, SampleColumns& samples) {
  const std::size_t end = samples.size();
  if (end > 0) chunks.replace(series, {}, samples, {&end, 1});
  samples = {};
}

}  // namespace

// A row of the table `sample` was a sample; NULL was a NaN.
void samples_to_chunks(sqlite::Connection& connection) {
  ChunkStore chunks(connection);
  SampleColumns samples;
  std::int64_t series = 0;
  sqlite::Query row = connection.query(
      "SELECT series, time, value, quality, source FROM sample ORDER BY series, time");
  while (row.step()) {
    if (row.integer(0) != series || samples.size() == chunk_samples) put(chunks, series, samples);
    series = row.integer(0);
    const double value = row.is_null(2) ? std::numeric_limits<double>::quiet_NaN() : row.real(2);
    samples.push_back(row.integer(1), {value, row.integer<Quality>(3), row.integer(4)});
  }
  put(chunks, series, samples);
}

}  // namespace reident::storage
