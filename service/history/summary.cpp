#include "service/history/summary.hpp"

#include <algorithm>
#include <optional>
#include <span>

#include "storage/chunks/sample_gaps.hpp"

namespace reident::history {
namespace {

constexpr std::size_t chunks_at_once = 8;
constexpr std::size_t measured_at_most = 4096;  // samples of a batch, for how they are sampled

class Summarising {
 public:
  explicit Summarising(const storage::TimeBins& bins) : bins_(bins) {}

  void add(const storage::SampleColumns& batch);
  SeriesSummary take() && { return std::move(summary_); }

 private:
  BinSummary& bin_at(storage::Time time);
  void add_gaps(std::span<const storage::Time> times);

  const storage::TimeBins& bins_;
  SeriesSummary summary_;
  storage::SamplingMeter meter_;
  storage::Sampling sampling_;
  std::optional<storage::Time> last_;
};

BinSummary& Summarising::bin_at(storage::Time time) {
  if (summary_.bins.empty() || time >= summary_.bins.back().bin.end) {
    BinSummary& bin = summary_.bins.emplace_back();
    bin.bin = bins_.at(bins_.of(time));
    bin.first = time;
  }
  return summary_.bins.back();
}

void Summarising::add(const storage::SampleColumns& batch) {
  add_gaps(batch.time);
  for (std::size_t i = 0; i < batch.size();) {
    BinSummary& bin = bin_at(batch.time[i]);
    const storage::Time end = bin.bin.end;
    for (; i < batch.size() && batch.time[i] < end; ++i) {
      const double value = batch.value[i];
      ++bin.samples;
      if (storage::is_better(bin.worst, batch.quality[i])) bin.worst = batch.quality[i];
      bin.numbers += value == value;
      if (value < bin.least) {
        bin.least = value;
        bin.least_time = batch.time[i];
      }
      if (value > bin.greatest) {
        bin.greatest = value;
        bin.greatest_time = batch.time[i];
      }
    }
    bin.last = batch.time[i - 1];
  }
}

void Summarising::add_gaps(std::span<const storage::Time> times) {
  const storage::Sampling before = sampling_;
  sampling_ = meter_.measure(times.first(std::min(times.size(), measured_at_most)));
  const auto add_gap = [this](const storage::SampleGap& gap) {
    if (gap.end - gap.begin >= bins_.length()) summary_.gaps.push_back({gap.begin, gap.end});
  };
  if (last_)
    if (const auto gap = storage::gap_between(*last_, before, times.front(), sampling_))
      add_gap(*gap);
  std::vector<storage::SampleGap> gaps;
  storage::append_gaps(times, sampling_, gaps);
  for (const storage::SampleGap& gap : gaps) add_gap(gap);
  last_ = times.back();
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
