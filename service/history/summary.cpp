#include "service/history/summary.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "storage/archive/holdings.hpp"

namespace reident::history {
namespace {

using storage::Time;

constexpr std::size_t chunks_at_once = 8;
constexpr std::size_t most_pieces = 4;  // of a chunk that are worth keeping
constexpr storage::WantedColumns wanted{true, true, false};
constexpr std::size_t measured_at_most = 4096;  // samples of a batch, for how they are sampled

/// Several extremes next to each other: one alone waits for each comparison before the next.
void add_values(BinSummary& bin, std::span<const double> values) {
  constexpr std::size_t lanes = 8;
  std::array<double, lanes> least{}, greatest{};
  std::array<std::uint64_t, lanes> numbers{};
  least.fill(bin.least);
  greatest.fill(bin.greatest);
  const auto add = [&](std::size_t lane, double value) {
    numbers[lane] += value == value;
    least[lane] = value < least[lane] ? value : least[lane];
    greatest[lane] = value > greatest[lane] ? value : greatest[lane];
  };
  std::size_t i = 0;
  for (; i + lanes <= values.size(); i += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) add(lane, values[i + lane]);
  for (; i < values.size(); ++i) add(i % lanes, values[i]);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    bin.numbers += numbers[lane];
    bin.least = std::min(bin.least, least[lane]);
    bin.greatest = std::max(bin.greatest, greatest[lane]);
  }
}

/// Adds samples [begin, end) of the batch, which lie in one bin.
void add_samples(BinSummary& bin, const storage::SampleColumns& batch, std::size_t begin,
                 std::size_t end) {
  const auto values = std::span(batch.value).subspan(begin, end - begin);
  const double least = bin.least, greatest = bin.greatest;
  add_values(bin, values);
  const auto time_of = [&](double value) {
    const auto place = std::find(values.begin(), values.end(), value) - values.begin();
    return batch.time[begin + static_cast<std::size_t>(place)];
  };
  if (bin.least < least) bin.least_time = time_of(bin.least);
  if (bin.greatest > greatest) bin.greatest_time = time_of(bin.greatest);
  for (const storage::Quality quality : std::span(batch.quality).subspan(begin, end - begin))
    if (quality != storage::Quality::good && storage::is_better(bin.worst, quality))
      bin.worst = quality;
  if (bin.samples == 0) bin.first = batch.time[begin];
  bin.samples += end - begin;
  bin.last = batch.time[end - 1];
}

/// Adds a later part of the same bin.
void add_piece(BinSummary& bin, const BinSummary& piece) {
  if (piece.least < bin.least) {
    bin.least = piece.least;
    bin.least_time = piece.least_time;
  }
  if (piece.greatest > bin.greatest) {
    bin.greatest = piece.greatest;
    bin.greatest_time = piece.greatest_time;
  }
  if (storage::is_better(bin.worst, piece.worst)) bin.worst = piece.worst;
  if (bin.samples == 0) bin.first = piece.first;
  bin.samples += piece.samples;
  bin.numbers += piece.numbers;
  bin.last = piece.last;
}

/// The samples of the batch from `begin` on that are before `time`: the end of them.
std::size_t end_before(const storage::SampleColumns& batch, std::size_t begin, Time time) {
  const auto behind =
      std::partition_point(batch.time.begin() + static_cast<std::ptrdiff_t>(begin),
                           batch.time.end(), [time](Time one) { return one < time; });
  return static_cast<std::size_t>(behind - batch.time.begin());
}

class Summarising {
 public:
  explicit Summarising(const storage::TimeBins& bins) : bins_(bins) {}

  void add(const storage::SampleColumns& batch);
  /// `sampling`: of the samples around the piece.
  void add(const BinSummary& piece, const storage::Sampling& sampling);
  SeriesSummary take() && { return std::move(summary_); }

 private:
  template <typename Sample>
  BinSummary& bin_at(Time time, const Sample& sampling);

  const storage::TimeBins& bins_;
  SeriesSummary summary_;
  storage::SamplingMeter meter_;
  storage::Sampling before_;
  std::optional<Time> last_;
};

/// A gap that is not shorter than a bin lies between samples of two bins.
template <typename Sample>
BinSummary& Summarising::bin_at(Time time, const Sample& sampling) {
  if (!summary_.bins.empty() && time < summary_.bins.back().bin.end) return summary_.bins.back();
  if (last_ && time - *last_ >= bins_.length())
    if (const auto gap = storage::gap_between(*last_, before_, time, sampling()))
      summary_.gaps.push_back({gap->begin, gap->end});
  BinSummary& bin = summary_.bins.emplace_back();
  bin.bin = bins_.at(bins_.of(time));
  return bin;
}

void Summarising::add(const storage::SampleColumns& batch) {
  std::optional<storage::Sampling> sampling;  // of the batch, once it was asked for
  const auto sample = [&] {
    if (!sampling)
      sampling =
          meter_.measure(std::span(batch.time).first(std::min(batch.size(), measured_at_most)));
    return *sampling;
  };
  for (std::size_t i = 0; i < batch.size();) {
    BinSummary& bin = bin_at(batch.time[i], sample);
    const std::size_t end = end_before(batch, i, bin.bin.end);
    add_samples(bin, batch, i, end);
    last_ = bin.last;
    i = end;
  }
  if (sampling) before_ = *sampling;
}

void Summarising::add(const BinSummary& piece, const storage::Sampling& sampling) {
  if (piece.samples == 0) return;
  add_piece(bin_at(piece.first, [&sampling] { return sampling; }), piece);
  last_ = piece.last;
  before_ = sampling;
}

/// The parts of a chunk in each bin that it meets, in which there may be nothing; absent where the
/// chunk is not there any more.
std::optional<std::vector<BinSummary>> pieces_of(const storage::Database& database,
                                                 const storage::ChunkOutline& chunk,
                                                 const storage::TimeBins& bins,
                                                 PieceMemory& memory) {
  std::vector<BinSummary> pieces;
  std::optional<storage::SampleColumns> samples;
  std::size_t at = 0;
  for (std::size_t bin = bins.of(chunk.first); bin <= bins.of(chunk.last); ++bin) {
    const storage::TimeRange range{std::max(bins.at(bin).begin, chunk.first),
                                   std::min(bins.at(bin).end, chunk.last + 1)};
    if (const auto known = memory.find(chunk, range)) {
      pieces.push_back(*known);
      continue;
    }
    if (!samples && !storage::read_chunk(database, chunk, wanted, samples.emplace()))
      return std::nullopt;
    at = end_before(*samples, at, range.begin);
    const std::size_t end = end_before(*samples, at, range.end);
    BinSummary& piece = pieces.emplace_back();
    piece.bin = range;
    if (end > at) add_samples(piece, *samples, at, end);
    memory.keep(chunk, piece);
    at = end;
  }
  return pieces;
}

}  // namespace

std::size_t PieceMemory::Hash::operator()(const Key& key) const {
  constexpr std::uint64_t odd = 0x9E3779B97F4A7C15;
  return key.chunk ^ (static_cast<std::uint64_t>(key.range.begin) * odd) ^
         (static_cast<std::uint64_t>(key.range.end) * (odd << 1 | 1));
}

std::optional<BinSummary> PieceMemory::find(const storage::ChunkOutline& chunk,
                                            storage::TimeRange range) const {
  const MutexLock lock(mutex_);
  const auto found = pieces_.find({chunk.identity, range});
  return found == pieces_.end() ? std::nullopt : std::optional(found->second);
}

void PieceMemory::keep(const storage::ChunkOutline& chunk, const BinSummary& piece) {
  const MutexLock lock(mutex_);
  if (pieces_.size() >= most_) pieces_.clear();
  pieces_.insert_or_assign({chunk.identity, piece.bin}, piece);
}

SeriesSummary summarise(const storage::Database& database, const storage::SeriesInfo& series,
                        const storage::TimeBins& bins, PieceMemory& memory,
                        const std::function<void()>& go_on) {
  Summarising summarising(bins);
  Time at = bins.range().begin;
  const auto read_until = [&](Time end) {
    if (at >= end) return;
    storage::SeriesBatches batches(database, series.id, {at, end}, chunks_at_once, wanted);
    for (storage::SampleColumns batch; batches.next(batch);) {
      summarising.add(batch);
      if (go_on) go_on();
    }
    at = end;
  };
  Time before = at;  // end of the outline before
  for (const storage::ChunkOutline& chunk :
       storage::chunk_outlines(database, series.id, bins.range())) {
    const bool was_read = at == before;
    before = chunk.last + 1;
    if (bins.of(chunk.last) - bins.of(chunk.first) >= most_pieces) continue;
    const auto pieces = pieces_of(database, chunk, bins, memory);
    if (!pieces) continue;
    if (!chunk.follows || !was_read) read_until(chunk.first);
    for (const BinSummary& piece : *pieces) summarising.add(piece, chunk.sampling);
    at = before;
    if (go_on) go_on();
  }
  read_until(bins.range().end);
  return std::move(summarising).take();
}

}  // namespace reident::history
