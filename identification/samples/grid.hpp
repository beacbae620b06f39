// From irregular samples of several channels to a Record on a uniform grid of time (METHOD.md,
// section 1).
//
// Tick k of the grid stands at the time k * period since the epoch, so that two windows of one
// equipment share their ticks. The value of a channel at a tick is its latest usable sample at or
// before the tick and younger than the sample hold (zero-order hold: what a live consumer would
// know).
#pragma once

#include <cstdint>
#include <span>

#include "identification/samples/record.hpp"

namespace reident::identification {

/// Samples of one channel, ascending in time, the three spans of one length. `usable[i] == 0` marks
/// a sample of bad quality; it ends the sample hold of the sample before it.
struct ChannelSamples {
  std::span<const std::int64_t> time_ns;
  std::span<const double> value;
  std::span<const std::uint8_t> usable;
};

struct GridOptions {
  std::int64_t period_ns = 1'000'000'000;
  std::int64_t sample_hold_ns = 1'000'000'000;  // a sample serves ticks in [time, time + this)
};

/// Returns the ticks in [begin_ns, end_ns) at which every channel has a value; any other tick is a
/// hole and splits the record. Samples before begin_ns may serve the first ticks. Non-finite values
/// count as unusable. Requires a positive period and sample hold. Nothing throws.
Record make_record(std::span<const ChannelSamples> inputs, std::span<const ChannelSamples> outputs,
                   std::int64_t begin_ns, std::int64_t end_ns, const GridOptions& options);

}  // namespace reident::identification
