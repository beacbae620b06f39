#include "service/history/summary.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "storage/chunks/sample_gaps.hpp"

namespace reident::history {
namespace {

using storage::Time;

constexpr std::size_t chunks_at_once = 8;
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

class Summarising {
 public:
  explicit Summarising(const storage::TimeBins& bins) : bins_(bins) {}

  void add(const storage::SampleColumns& batch);
  SeriesSummary take() && { return std::move(summary_); }

 private:
  /// Adds samples [begin, end) of the batch, which lie in one bin.
  static void add(BinSummary& bin, const storage::SampleColumns& batch, std::size_t begin,
                  std::size_t end);
  BinSummary& bin_at(Time time, std::span<const Time> batch);

  const storage::TimeBins& bins_;
  SeriesSummary summary_;
  storage::SamplingMeter meter_;
  std::optional<storage::Sampling> sampling_;  // of the batch, once it was asked for
  storage::Sampling before_;                   // of batches before it
  std::optional<Time> last_;
};

/// A gap that is not shorter than a bin lies between samples of two bins.
BinSummary& Summarising::bin_at(Time time, std::span<const Time> batch) {
  if (!summary_.bins.empty() && time < summary_.bins.back().bin.end) return summary_.bins.back();
  if (last_ && time - *last_ >= bins_.length()) {
    if (!sampling_)
      sampling_ = meter_.measure(batch.first(std::min(batch.size(), measured_at_most)));
    if (const auto gap = storage::gap_between(*last_, before_, time, *sampling_))
      summary_.gaps.push_back({gap->begin, gap->end});
  }
  BinSummary& bin = summary_.bins.emplace_back();
  bin.bin = bins_.at(bins_.of(time));
  bin.first = time;
  return bin;
}

void Summarising::add(const storage::SampleColumns& batch) {
  if (sampling_) before_ = *sampling_;
  sampling_.reset();
  for (std::size_t i = 0; i < batch.size();) {
    BinSummary& bin = bin_at(batch.time[i], batch.time);
    const auto behind =
        std::partition_point(batch.time.begin() + static_cast<std::ptrdiff_t>(i), batch.time.end(),
                             [&bin](Time time) { return time < bin.bin.end; });
    const auto end = static_cast<std::size_t>(behind - batch.time.begin());
    add(bin, batch, i, end);
    last_ = bin.last;
    i = end;
  }
}

void Summarising::add(BinSummary& bin, const storage::SampleColumns& batch, std::size_t begin,
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
  bin.samples += end - begin;
  bin.last = batch.time[end - 1];
}

}  // namespace

SeriesSummary summarise(const TelemetryReader& telemetry, const storage::SeriesInfo& series,
                        const storage::TimeBins& bins, const std::function<void()>& go_on) {
  Summarising summarising(bins);
  const auto batches = telemetry.batches(series, bins.range(), chunks_at_once, {true, true, false});
  for (storage::SampleColumns batch; batches->next(batch);) {
    summarising.add(batch);
    if (go_on) go_on();
  }
  return std::move(summarising).take();
}

}  // namespace reident::history
