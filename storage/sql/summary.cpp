#include "storage/sql/summary.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <span>
#include <utility>

#include "storage/types/time_ends.hpp"

namespace reident::storage::sql {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Several sums side by side: one alone waits for each addition before the next.
void add_values(Summary& summary, std::span<const double> values) {
  constexpr std::size_t lanes = 8;
  std::array<double, lanes> sum{}, least, greatest;
  std::array<std::uint64_t, lanes> numbers{};
  least.fill(infinity);
  greatest.fill(-infinity);
  const auto add = [&](std::size_t lane, double value) {
    const bool is_number = value == value;
    numbers[lane] += is_number;
    sum[lane] += is_number ? value : 0.0;
    least[lane] = value < least[lane] ? value : least[lane];
    greatest[lane] = value > greatest[lane] ? value : greatest[lane];
  };
  std::size_t i = 0;
  for (; i + lanes <= values.size(); i += lanes)
    for (std::size_t lane = 0; lane < lanes; ++lane) add(lane, values[i + lane]);
  for (; i < values.size(); ++i) add(i % lanes, values[i]);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    summary.numbers += numbers[lane];
    summary.sum += sum[lane];
    summary.least = std::min(summary.least, least[lane]);
    summary.greatest = std::max(summary.greatest, greatest[lane]);
  }
}

}  // namespace

Summaries::Summaries(ArchiveFile& file, SummaryRequest request)
    : file_(file), request_(std::move(request)) {
  if (!request_.selection.time.empty()) series_ = file_.find(request_.selection);
}

std::optional<Time> Summaries::bucket_of(Time time) const {
  if (!request_.step) return std::nullopt;
  const std::int64_t step = *request_.step;
  const std::int64_t above = time % step < 0 ? time % step + step : time % step;
  return earlier(time, above);
}

bool Summaries::next() {
  for (; at_ < series_.size(); ++at_) {
    if (!blocks_) {
      const SeriesBlocks::Options options{
          .wanted = {request_.extremes || request_.values || request_.times, request_.quality,
                     false}};
      blocks_ = std::make_unique<SeriesBlocks>(file_, series_[at_], request_.selection, options);
      row_ = 0;
    }
    if (next_of_series()) return true;
    blocks_.reset();
  }
  return false;
}

bool Summaries::next_of_series() {
  summary_ = {};
  while (has_more()) {
    const auto bucket = bucket_of(chunk_ ? chunk_->first_time : blocks_->block().time[row_]);
    if (summary_.samples == 0) summary_.bucket = bucket;
    if (summary_.bucket != bucket) return true;
    chunk_ ? add_chunk() : add_rows();
  }
  return summary_.samples > 0;
}

bool Summaries::has_more() {
  if (chunk_ || row_ < blocks_->block().size()) return true;
  if (!request_.needs_rows())
    chunk_ = blocks_->take_undecoded([this](const ChunkEntry& chunk) {
      return bucket_of(chunk.first_time) == bucket_of(chunk.last_time);
    });
  if (chunk_) return true;
  row_ = 0;
  return blocks_->next();
}

void Summaries::add_rows() {
  const SampleColumns& block = blocks_->block();
  const auto begin = block.time.begin() + static_cast<std::ptrdiff_t>(row_);
  const auto end = std::partition_point(
      begin, block.time.end(), [this](Time time) { return bucket_of(time) == summary_.bucket; });
  const auto count = static_cast<std::size_t>(end - begin);
  if (summary_.samples == 0) summary_.first_time = *begin;
  summary_.last_time = *(end - 1);
  if (!block.value.empty()) add_values_of(count);
  if (request_.quality) {
    const auto qualities = std::span(block.quality).subspan(row_, count);
    const Quality worst = *std::max_element(qualities.begin(), qualities.end(), is_better);
    if (is_better(summary_.worst_quality, worst)) summary_.worst_quality = worst;
  }
  summary_.samples += count;
  row_ += count;
}

void Summaries::add_values_of(std::size_t count) {
  const SampleColumns& block = blocks_->block();
  const auto values = std::span(block.value).subspan(row_, count);
  if (summary_.samples == 0) summary_.first_value = values.front();
  summary_.last_value = values.back();
  const Summary before = summary_;
  add_values(summary_, values);
  if (!request_.times || summary_.numbers == 0) return;
  const auto time_of = [&](double value) {
    const auto at = std::find(values.begin(), values.end(), value) - values.begin();
    return block.time[row_ + static_cast<std::size_t>(at)];
  };
  const bool is_first = before.numbers == 0;
  if (is_first || summary_.least < before.least) summary_.least_time = time_of(summary_.least);
  if (is_first || summary_.greatest > before.greatest)
    summary_.greatest_time = time_of(summary_.greatest);
}

void Summaries::add_chunk() {
  if (summary_.samples == 0) summary_.first_time = chunk_->first_time;
  summary_.last_time = chunk_->last_time;
  summary_.least = std::min(summary_.least, chunk_->least);
  summary_.greatest = std::max(summary_.greatest, chunk_->greatest);
  summary_.samples += chunk_->samples;
  chunk_.reset();
}

}  // namespace reident::storage::sql
