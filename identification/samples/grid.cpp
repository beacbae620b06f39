#include "identification/samples/grid.hpp"

#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace reident::identification {
namespace {

/// Smallest tick whose time is not before `time_ns`, right for negative times too.
std::int64_t tick_at_or_after(std::int64_t time_ns, std::int64_t period_ns) {
  const std::int64_t quotient = time_ns / period_ns;  // rounds towards zero
  return quotient + (time_ns % period_ns > 0 ? 1 : 0);
}

/// Walks one channel's samples along ascending times.
class Cursor {
 public:
  Cursor(const ChannelSamples& channel, std::int64_t sample_hold_ns)
      : channel_(channel), sample_hold_ns_(sample_hold_ns) {}

  /// The value that holds at `time_ns`, which never decreases from call to call.
  std::optional<double> value_at(std::int64_t time_ns) {
    while (next_ < channel_.time_ns.size() && channel_.time_ns[next_] <= time_ns) ++next_;
    if (next_ == 0 || !usable(next_ - 1)) return std::nullopt;
    // Unsigned, since the distance of two int64 may not fit in one.
    const auto age = static_cast<std::uint64_t>(time_ns) -
                     static_cast<std::uint64_t>(channel_.time_ns[next_ - 1]);
    if (age >= static_cast<std::uint64_t>(sample_hold_ns_)) return std::nullopt;
    return channel_.value[next_ - 1];
  }

  /// Time of the first usable sample after the last call's time.
  std::optional<std::int64_t> next_usable_time() const {
    std::size_t i = next_;
    while (i < channel_.time_ns.size() && !usable(i)) ++i;
    if (i == channel_.time_ns.size()) return std::nullopt;
    return channel_.time_ns[i];
  }

 private:
  bool usable(std::size_t i) const {
    return channel_.usable[i] != 0 && std::isfinite(channel_.value[i]);
  }

  ChannelSamples channel_;
  std::int64_t sample_hold_ns_;
  std::size_t next_ = 0;  // first sample after the last call's time
};

/// Rows of all channels side by side, as they are found.
struct Rows {
  std::vector<double> values;
  std::vector<Segment> segments;
  Index count = 0;

  void append(const std::vector<double>& row, std::int64_t tick) {
    values.insert(values.end(), row.begin(), row.end());
    const bool follows = !segments.empty() && segments.back().end_tick() == tick;
    if (!follows) segments.push_back({count, count, tick});
    segments.back().end = ++count;
  }
};

}  // namespace

Record make_record(std::span<const ChannelSamples> inputs, std::span<const ChannelSamples> outputs,
                   std::int64_t begin_ns, std::int64_t end_ns, const GridOptions& options) {
  assert(options.period_ns > 0 && options.sample_hold_ns > 0);
  const std::int64_t period = options.period_ns;
  std::vector<Cursor> cursors;
  for (const ChannelSamples& channel : inputs)
    cursors.emplace_back(channel, options.sample_hold_ns);
  for (const ChannelSamples& channel : outputs)
    cursors.emplace_back(channel, options.sample_hold_ns);

  Rows rows;
  std::vector<double> row(cursors.size());
  std::int64_t tick = tick_at_or_after(begin_ns, period);
  const std::int64_t end_tick = begin_ns < end_ns ? tick_at_or_after(end_ns, period) : tick;
  while (tick < end_tick && !cursors.empty()) {
    std::size_t c = 0;
    for (; c < cursors.size(); ++c) {
      const std::optional<double> value = cursors[c].value_at(tick * period);
      if (!value) break;
      row[c] = *value;
    }
    if (c == cursors.size()) {
      rows.append(row, tick++);
      continue;
    }
    // Nothing can come before the silent channel speaks again: gaps cost nothing.
    const std::optional<std::int64_t> next = cursors[c].next_usable_time();
    if (!next) break;
    tick = tick_at_or_after(*next, period);
  }

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Index m = static_cast<Index>(inputs.size()), p = static_cast<Index>(outputs.size());
  const Eigen::Map<const RowMajor> all(rows.values.data(), rows.count, m + p);
  return {static_cast<double>(period) * 1e-9, all.leftCols(m), all.rightCols(p),
          std::move(rows.segments)};
}

}  // namespace reident::identification
