#include "storage/sql/series_blocks.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace reident::storage::sql {
namespace {

/// Moves the elements whose rows are kept to the front.
template <typename T>
void keep_rows(std::vector<T>& column, const std::vector<std::size_t>& rows) {
  if (column.empty()) return;
  for (std::size_t i = 0; i < rows.size(); ++i) column[i] = column[rows[i]];
  column.resize(rows.size());
}

void turn_round(SampleColumns& columns) {
  std::reverse(columns.time.begin(), columns.time.end());
  std::reverse(columns.value.begin(), columns.value.end());
  std::reverse(columns.quality.begin(), columns.quality.end());
  std::reverse(columns.source.begin(), columns.source.end());
}

// Keeps the memory.
void clear(SampleColumns& columns) {
  columns.time.clear();
  columns.value.clear();
  columns.quality.clear();
  columns.source.clear();
}

}  // namespace

SeriesBlocks::SeriesBlocks(ArchiveFile& file, const SeriesName& series, const Selection& selection,
                           const Options& options)
    : file_(file),
      series_(series),
      selection_(selection),
      options_(options),
      left_(selection.time) {
  options_.wanted.value |= selection.by_value;
  options_.wanted.quality |= !selection.quality.all();
  options_.wanted.source |= !selection.source.all();
}

bool SeriesBlocks::next() {
  while (load()) {
    filter();
    if (block_.time.empty()) continue;
    if (options_.descending) turn_round(block_);
    return true;
  }
  return false;
}

std::optional<ChunkEntry> SeriesBlocks::next_chunk() {
  const auto chunk = options_.descending ? file_.chunk_to(series_.id, left_.last)
                                         : file_.chunk_from(series_.id, left_.first);
  if (!chunk || chunk->first_time > left_.last || chunk->last_time < left_.first)
    return std::nullopt;
  return chunk;
}

// Reads the next piece of what is left, which may turn out to have no row.
bool SeriesBlocks::load() {
  clear(block_);
  if (left_.empty()) return false;
  TimeBounds piece = left_;
  const auto chunk = next_chunk();
  const auto fragment = file_.next_fragment(series_, left_, options_.descending);
  if (fragment && (!chunk || comes_before(*fragment, *chunk))) {
    end_with(*fragment, piece);
    if (chunk) end_before(*chunk, piece);
  } else if (chunk) {
    load_chunk(*chunk, piece);
  }
  file_.lay_recent_over(block_, series_, piece, options_.wanted);
  leave(piece);
  return true;
}

// Goes on behind the piece, which begins where what is left does.
void SeriesBlocks::leave(TimeBounds piece) {
  const bool is_last = options_.descending ? piece.first == left_.first : piece.last == left_.last;
  if (is_last) {
    left_.clear();
  } else if (options_.descending) {
    left_.last = piece.first - 1;
  } else {
    left_.first = piece.last + 1;
  }
}

std::optional<ChunkEntry> SeriesBlocks::take_undecoded(
    const std::function<bool(const ChunkEntry&)>& fits) {
  if (left_.empty() || filters()) return std::nullopt;
  const auto chunk = next_chunk();
  if (!chunk || chunk->first_time < left_.first || chunk->last_time > left_.last || !fits(*chunk))
    return std::nullopt;
  TimeBounds piece = left_;
  end_with({chunk->first_time, chunk->last_time}, piece);
  if (file_.next_fragment(series_, piece, options_.descending)) return std::nullopt;
  leave(piece);
  return chunk;
}

bool SeriesBlocks::filters() const {
  return selection_.by_value || !selection_.quality.all() || !selection_.source.all();
}

// Whether some of the fragment lies on this side of the chunk.
bool SeriesBlocks::comes_before(TimeBounds fragment, const ChunkEntry& chunk) const {
  return options_.descending ? std::min(fragment.last, left_.last) > chunk.last_time
                             : std::max(fragment.first, left_.first) < chunk.first_time;
}

void SeriesBlocks::end_before(const ChunkEntry& chunk, TimeBounds& piece) const {
  if (options_.descending) {
    piece.first = std::max(piece.first, chunk.last_time + 1);
  } else {
    piece.last = std::min(piece.last, chunk.first_time - 1);
  }
}

void SeriesBlocks::end_with(TimeBounds range, TimeBounds& piece) const {
  if (options_.descending) {
    piece.first = std::max(piece.first, range.first);
  } else {
    piece.last = std::min(piece.last, range.last);
  }
}

void SeriesBlocks::load_chunk(const ChunkEntry& chunk, TimeBounds& piece) {
  end_with({chunk.first_time, chunk.last_time}, piece);
  if (selection_.by_value &&
      (chunk.greatest < selection_.least || chunk.least > selection_.greatest))
    return;
  if (chunk.samples <= options_.most_rows)
    return file_.decode(series_, chunk, piece, block_.target(options_.wanted));

  SampleColumns& all = file_.scratch;
  clear(all);
  file_.decode(series_, chunk, piece, all.target(options_.wanted));
  if (all.size() <= options_.most_rows) return block_.append(all, 0, all.size());
  if (options_.descending) {
    block_.append(all, all.size() - options_.most_rows, all.size());
    piece.first = block_.time.front();
  } else {
    block_.append(all, 0, options_.most_rows);
    piece.last = block_.time.back();
  }
}

void SeriesBlocks::filter() {
  if (!filters()) return;
  std::array<bool, qualities.size()> quality_fits{};
  for (const Quality quality : qualities)
    quality_fits[wire_value(quality)] = selection_.quality.has(name(quality));
  std::int64_t source = -1;
  bool source_fits = false;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < block_.time.size(); ++i) {
    if (selection_.by_value &&
        !(block_.value[i] >= selection_.least && block_.value[i] <= selection_.greatest))
      continue;
    if (!selection_.quality.all() && !quality_fits[wire_value(block_.quality[i])]) continue;
    if (!selection_.source.all()) {
      if (source != block_.source[i] || i == 0) {
        source = block_.source[i];
        const std::string_view its_name = file_.source_name(source);
        source_fits = its_name.data() != nullptr && selection_.source.has(its_name);
      }
      if (!source_fits) continue;
    }
    kept.push_back(i);
  }
  if (kept.size() == block_.time.size()) return;
  keep_rows(block_.time, kept);
  keep_rows(block_.value, kept);
  keep_rows(block_.quality, kept);
  keep_rows(block_.source, kept);
}

}  // namespace reident::storage::sql
