#include "identification/screening/channels.hpp"

#include <algorithm>
#include <cmath>

namespace reident::identification {
namespace {

constexpr double jump_steps = 20;
constexpr double jump_range_share = 0.05;
constexpr double tails = 0.01;  // of the samples at either end: a few faults do not widen the range

std::vector<Plateau> plateaus_of(const Vector& values, const std::vector<Segment>& segments) {
  std::vector<Plateau> plateaus;
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
  for (std::size_t i = 1; i < plateaus.size(); ++i)
    if (plateaus[i].segment == plateaus[i - 1].segment)
      steps.push_back(std::abs(plateaus[i].value - plateaus[i - 1].value));
  const double usual = steps.empty() ? 0 : quantile(std::move(steps), 0.5);
  std::vector<double> values(channel.values.begin(), channel.values.end());
  const double high = quantile(values, 1 - tails);
  const double range = high - quantile(std::move(values), tails);
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

double quantile(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * double(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

double movement(const Vector& values, Index begin, Index end) {
  const auto there = values.segment(begin, end - begin);
  return there.maxCoeff() - there.minCoeff();
}

}  // namespace reident::identification
