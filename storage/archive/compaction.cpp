#include "storage/archive/compaction.hpp"

#include <algorithm>

#include "storage/chunks/overlay.hpp"

namespace reident::storage {
namespace {

// A smaller neighbour is rewritten with what comes when it has at most so many times its samples:
// each sample is then rewritten a few times, and few small chunks stay.
constexpr std::size_t worth_joining = 3;
constexpr std::size_t rows_of_a_step = 4096;

}  // namespace

void Compaction::begin() {
  round_ = Round{.batch = recent_.next_batch() - 1, .series = recent_.waiting()};
  std::reverse(round_->series.begin(), round_->series.end());
}

void Compaction::step(std::size_t samples) {
  std::size_t work = 0;
  while (!round_->series.empty()) {
    if (work >= samples) return;
    SeriesHead& series = recent_.series(round_->series.back());
    if (round_->samples.empty()) gather(series);
    while (round_->done < round_->samples.size() && work < samples) work += move_range(series.id);
    if (round_->done < round_->samples.size()) return;
    recent_.moved(series, round_->batch);
    round_->series.pop_back();
    round_->samples.cut(0);
    round_->done = 0;
  }
  if (!recent_.remove_rows(round_->batch, rows_of_a_step)) round_.reset();
}

void Compaction::gather(const SeriesHead& series) {
  std::vector<const SampleColumns*> fragments;
  for (const SeriesHead::Fragment& fragment : series.fragments)
    if (fragment.batch <= round_->batch) fragments.push_back(&fragment.samples);
  overlay(round_->samples, fragments);
}

std::size_t Compaction::move_range(std::int64_t series) {
  const std::vector<Time>& time = round_->samples.time;
  const std::size_t first = round_->done;
  const std::optional<ChunkRow> base = chunks_.at_or_before(series, time[first]);
  const std::optional<ChunkRow> next = chunks_.after(series, time[first]);
  const auto limit = next ? std::lower_bound(time.begin() + static_cast<std::ptrdiff_t>(first),
                                             time.end(), next->first)
                          : time.end();
  // No more than a chunk can take in, so that a range is a bounded piece of work.
  const std::size_t last =
      std::min(static_cast<std::size_t>(limit - time.begin()), first + 4 * chunk_samples_);
  round_->done = last;

  std::vector<ChunkRow> old;  // neighbours, the latest first until they are all found
  std::size_t total = last - first;
  const auto is_worth_joining = [&](const ChunkRow& row) {
    return row.place.shard == 0 && row.samples < chunk_samples_ &&
           row.samples <= worth_joining * total;
  };
  for (std::optional<ChunkRow> row = base;
       row && (row->last >= time[first] || is_worth_joining(*row));
       row = chunks_.before(series, row->first)) {
    old.push_back(*row);
    total += row->samples;
  }
  std::reverse(old.begin(), old.end());
  const bool joins_next = next && static_cast<std::size_t>(limit - time.begin()) == last &&
                          total + next->samples <= chunk_samples_ && is_worth_joining(*next);
  if (joins_next) old.push_back(*next);

  SampleColumns merged;
  merged.reserve(total + (joins_next ? next->samples : 0));
  try {
    for (const ChunkRow& row : old) chunks_.take(row, merged);
  } catch (const ShardError& why) {
    return postpone(series, first, base->last, why);
  }
  SampleColumns moving;
  moving.append(round_->samples, first, last);
  overlay(merged, {&moving});
  const bool at_the_end = !next || (joins_next && !chunks_.after(series, next->first));
  chunks_.replace(series, old, merged, piece_ends(merged.size(), at_the_end));
  return merged.size();
}

// What lands behind the chunk that cannot be read goes on.
std::size_t Compaction::postpone(std::int64_t series, std::size_t first, Time last,
                                 const ShardError& why) {
  const SampleColumns& samples = round_->samples;
  std::size_t end = first;
  for (; end < samples.size() && samples.time[end] <= last; ++end)
    postponed_.add({.series = series,
                    .time = samples.time[end],
                    .sample = {samples.value[end], samples.quality[end], samples.source[end]},
                    .is_settled = true},
                   why);
  round_->done = end;
  return end - first;
}

std::vector<std::size_t> Compaction::piece_ends(std::size_t samples, bool at_the_end) const {
  std::vector<std::size_t> ends;
  if (at_the_end) {
    for (std::size_t end = chunk_samples_; end < samples; end += chunk_samples_)
      ends.push_back(end);
    ends.push_back(samples);
    return ends;
  }
  const std::size_t largest = chunk_samples_ + chunk_samples_ / 2;
  const std::size_t pieces = (samples + largest - 1) / largest;
  for (std::size_t piece = 1; piece <= pieces; ++piece) ends.push_back(samples * piece / pieces);
  return ends;
}

}  // namespace reident::storage
