#include "identification/screening/channels.hpp"

#include <algorithm>
#include <cmath>

#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr double jump_steps = 20;
constexpr double jump_range_share = 0.05;
constexpr double tails = 0.01;  // of the samples at either end: a few faults do not widen the range

std::vector<Plateau> plateaus_of(const Vector& values, const std::vector<Segment>& segments) {
  std::vector<Plateau> plateaus;
  plateaus.reserve(static_cast<std::size_t>(values.size()));
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (Index row = segments[s].begin; row < segments[s].end; ++row) {
      if (row == segments[s].begin || values(row) != plateaus.back().value)
        plateaus.push_back({row, row, values(row), s});
      plateaus.back().end = row + 1;
    }
  return plateaus;
}

double least_jump_of(const Channel& channel) {
  const std::vector<Plateau>& plateaus = channel.plateaus;
  std::vector<double> steps;
  steps.reserve(plateaus.size());
  for (std::size_t i = 1; i < plateaus.size(); ++i)
    if (plateaus[i].segment == plateaus[i - 1].segment)
      steps.push_back(std::abs(plateaus[i].value - plateaus[i - 1].value));
  const double usual = steps.empty() ? 0 : quantile(steps, 0.5);
  const std::span<const double> values(channel.values.data(),
                                       static_cast<std::size_t>(channel.values.size()));
  const double range = quantile(values, 1 - tails) - quantile(values, tails);
  return std::max(jump_steps * usual, jump_range_share * range);
}

}  // namespace

std::vector<Channel> channels_of(const Record& record, const std::vector<bool>& analog) {
  const Index inputs = record.u.cols(), outputs = record.y.cols();
  std::vector<Channel> channels;
  for (Index c = 0; c < inputs + outputs; ++c) {
    Channel channel;
    channel.values = c < inputs ? record.u.col(c) : record.y.col(c - inputs);
    channel.is_analog = analog[static_cast<std::size_t>(c)];
    channel.low = channel.values.minCoeff();
    channel.high = channel.values.maxCoeff();
    if (channel.is_analog) {
      channel.plateaus = plateaus_of(channel.values, record.segments);
      channel.least_jump = least_jump_of(channel);
    }
    channels.push_back(std::move(channel));
  }
  return channels;
}

double median_size(const std::vector<Plateau>& plateaus) {
  std::vector<double> sizes;
  sizes.reserve(plateaus.size());
  for (const Plateau& plateau : plateaus) sizes.push_back(double(plateau.size()));
  return quantile(sizes, 0.5);
}

double movement(const Vector& values, Index begin, Index end) {
  const auto there = values.segment(begin, end - begin);
  return there.maxCoeff() - there.minCoeff();
}

}  // namespace reident::identification
