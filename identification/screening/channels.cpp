#include "identification/screening/channels.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "identification/screening/order_statistics.hpp"

namespace reident::identification {
namespace {

constexpr double jump_steps = 20;
constexpr double jump_range_share = 0.05;
constexpr double tails = 0.01;  // of the samples at either end: a few faults do not widen the range

/// What `channel` steps by from row to row, in an analog channel's usual terms.
void describe_steps(Channel& channel) {
  const auto steps =
      std::make_unique_for_overwrite<double[]>(static_cast<std::size_t>(channel.values.size()));
  std::size_t count = 0;
  double greatest = 0;
  Index longest = 0;
  const double* values = channel.values.data();
  for (const Segment& segment : *channel.segments) {
    Index changed = segment.begin;  // the row at which the value last did
    for (Index row = segment.begin + 1; row < segment.end; ++row) {
      const double step = std::abs(values[row] - values[row - 1]);
      steps[count] = step;
      greatest = std::max(greatest, step);
      // Without branches, which nobody foresees.
      const Index changes = values[row] == values[row - 1] ? 0 : 1;
      count += static_cast<std::size_t>(changes);
      changed += (row - changed) * changes;
      longest = std::max(longest, row - changed + 1);
    }
    if (segment.size() > 0) longest = std::max<Index>(longest, 1);
  }
  channel.steps = static_cast<Index>(count);
  channel.greatest_step = greatest;
  channel.longest_repeat = longest;
  const double usual = count == 0 ? 0 : quantile({steps.get(), count}, 0.5);
  const std::span<const double> all = span_of(channel.values);
  const double range = quantile(all, 1 - tails) - quantile(all, tails);
  channel.least_jump = std::max(jump_steps * usual, jump_range_share * range);
}

}  // namespace

std::vector<Plateau> Channel::plateaus() const {
  std::vector<Plateau> found;
  found.reserve(static_cast<std::size_t>(steps) + segments->size());
  for (std::size_t s = 0; s < segments->size(); ++s) {
    const Segment& segment = (*segments)[s];
    for (Index row = segment.begin; row < segment.end; ++row) {
      if (row == segment.begin || values(row) != found.back().value)
        found.push_back({row, row, values(row), s});
      found.back().end = row + 1;
    }
  }
  return found;
}

std::vector<Channel> channels_of(const Record& record, const std::vector<bool>& analog) {
  const Index inputs = record.u.cols(), outputs = record.y.cols();
  std::vector<Channel> channels;
  for (Index c = 0; c < inputs + outputs; ++c) {
    Channel channel;
    channel.values = c < inputs ? record.u.col(c) : record.y.col(c - inputs);
    channel.is_analog = analog[static_cast<std::size_t>(c)];
    channel.low = channel.values.minCoeff();
    channel.high = channel.values.maxCoeff();
    channel.segments = &record.segments;
    if (channel.is_analog) describe_steps(channel);
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
