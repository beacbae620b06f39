#include "service/history/summary.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace reident::history {
namespace {

using storage::Quality;
using storage::Time;

/// Samples in memory, handed out in batches.
class Samples final : public TelemetryReader {
 public:
  explicit Samples(storage::SampleColumns columns, std::size_t batch)
      : columns_(std::move(columns)), batch_(batch) {}

  std::unique_ptr<SampleBatches> batches(const storage::SeriesInfo&, storage::TimeRange range,
                                         std::size_t, storage::WantedColumns) const override {
    struct Some final : SampleBatches {
      bool next(storage::SampleColumns& out) override {
        out = {};
        for (; at < of->columns_.size() && out.size() < of->batch_; ++at)
          if (of->columns_.time[at] >= range.begin && of->columns_.time[at] < range.end)
            out.append(of->columns_, at, at + 1);
        return !out.empty();
      }
      const Samples* of = nullptr;
      storage::TimeRange range;
      std::size_t at = 0;
    };
    auto some = std::make_unique<Some>();
    some->of = this;
    some->range = range;
    return some;
  }
  std::optional<storage::ParameterDescriptor> parameter(const std::string&,
                                                        const std::string&) const override {
    return std::nullopt;
  }
  storage::Series read(const std::string&, storage::Origin, std::uint32_t,
                       storage::TimeRange) const override {
    return {};
  }
  std::vector<storage::SeriesInfo> series() const override { return {}; }
  std::map<std::int64_t, std::string> source_names() const override { return {}; }
  std::vector<storage::BinCounts> completeness(const storage::SeriesInfo&, const storage::TimeBins&,
                                               Time) const override {
    return {};
  }
  std::vector<storage::SequenceGap> sequence_gaps() const override { return {}; }

 private:
  storage::SampleColumns columns_;
  std::size_t batch_;
};

constexpr Time second = storage::second_ns;

// A naive summary of each bin is the oracle.
TEST(Summary, HasTheExtremesOfEachBinAtTheirTimes) {
  std::mt19937 random(20261126);
  storage::SampleColumns columns;
  Time time = 0;
  for (int i = 0; i < 5000; ++i) {
    time += second * (1 + (random() % 50 == 0 ? 40 : 0));
    const double value = random() % 90 == 0 ? NAN : std::normal_distribution<>(3, 1)(random);
    columns.push_back(time, {value, random() % 100 == 0 ? Quality::suspect : Quality::good, 1});
  }
  const storage::TimeBins bins({100 * second + 5, 4000 * second}, 37 * second);
  const SeriesSummary summary = summarise(Samples(columns, 333), {}, bins);
  std::size_t samples = 0;
  for (const BinSummary& bin : summary.bins) {
    double least = INFINITY, greatest = -INFINITY;
    std::uint64_t count = 0;
    Quality worst = Quality::good;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (columns.time[i] < bin.bin.begin || columns.time[i] >= bin.bin.end) continue;
      ++count;
      if (columns.value[i] < least) least = columns.value[i];
      if (columns.value[i] > greatest) greatest = columns.value[i];
      if (columns.quality[i] == Quality::suspect) worst = Quality::suspect;
      if (columns.time[i] == bin.least_time) {
        EXPECT_EQ(columns.value[i], bin.least);
      }
      if (columns.time[i] == bin.greatest_time) {
        EXPECT_EQ(columns.value[i], bin.greatest);
      }
    }
    ASSERT_EQ(bin.samples, count);
    EXPECT_EQ(bin.least, least);
    EXPECT_EQ(bin.greatest, greatest);
    EXPECT_EQ(bin.worst, worst);
    samples += bin.samples;
  }
  std::size_t in_range = 0;
  for (const Time at : columns.time) in_range += at >= bins.range().begin && at < bins.range().end;
  EXPECT_EQ(samples, in_range);
}

TEST(Summary, NamesTheGapsThatAreNotShorterThanABin) {
  storage::SampleColumns columns;
  for (Time at = 0; at < 1000; ++at)
    if ((at < 300 || at >= 400) && (at < 600 || at >= 605))
      columns.push_back(at * second, {1, Quality::good, 1});
  const storage::TimeBins bins({0, 1000 * second}, 10 * second);
  for (const std::size_t batch : {7U, 300U, 5000U}) {
    const auto gaps = summarise(Samples(columns, batch), {}, bins).gaps;
    ASSERT_EQ(gaps.size(), 1U) << batch;
    EXPECT_EQ(gaps[0], (storage::TimeRange{299 * second, 400 * second}));
  }
}

TEST(Summary, OfNothingIsEmpty) {
  const SeriesSummary summary = summarise(Samples({}, 10), {}, storage::TimeBins({0, 100}, 10));
  EXPECT_TRUE(summary.bins.empty());
  EXPECT_TRUE(summary.gaps.empty());
}

}  // namespace
}  // namespace reident::history
