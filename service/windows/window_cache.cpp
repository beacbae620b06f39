#include "service/windows/window_cache.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "service/support/floor_divide.hpp"
#include "service/windows/caching_reader.hpp"

namespace reident {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::TickRange;
using identification::TickSet;
using identification::Vector;

namespace {

/// WindowData::bias_effects of the sensor, for biases of a tenth of its values up and down. Where
/// one of them gives no input that is finite, the other counts. What is not analog has no bias.
Record bias_effect(const WindowRequest& request, const std::vector<Channel>& channels,
                   const Record& all, const std::string& sensor, TickRange ticks) {
  InputExpressions expressions(request.inputs, request.derived);
  const auto& names = expressions.parameters();
  const auto place = std::ranges::find(names, sensor) - names.begin();
  const bool is_analog = channels[static_cast<std::size_t>(place)].is_analog;
  const double values = std::sqrt(all.u.col(place).squaredNorm() /
                                  static_cast<double>(std::max<Index>(1, all.rows())));
  const double bias = values > 0 ? values / 10 : 1;
  const Record samples = rows_at(all, ticks);
  Record effect = expressions.evaluate(samples);
  const Index m = effect.u.cols();
  effect.u.setZero();
  effect.y.resize(effect.rows(), 1);
  Vector raw(samples.u.cols()), above(m), here(m), below(m);
  const auto inputs_at = [&](Index row, double offset, Vector& found) {
    raw = samples.u.row(row).transpose();
    raw(place) += offset;
    expressions.evaluate(raw, found);
    return found.allFinite();
  };
  Index kept = 0;
  for (Index row = 0; row < samples.rows(); ++row) {
    if (!inputs_at(row, 0, here)) continue;  // it is not in the record
    effect.y(kept, 0) = samples.u(row, place);
    double width = is_analog ? 2 * bias : 0;
    if (is_analog && !inputs_at(row, bias, above)) above = here, width -= bias;
    if (is_analog && !inputs_at(row, -bias, below)) below = here, width -= bias;
    if (width > 0) effect.u.row(kept) = (above - below).transpose() / width;
    ++kept;
  }
  return effect;
}

}  // namespace

WindowCache::WindowCache(const WindowRequest& request, identification::Index block_rows,
                         const Checks& checks)
    : request_(request),
      checks_(request, checks),
      sums_({static_cast<identification::Index>(request.inputs.size() + request.outputs.size()),
             block_rows, ChunkCache::chunk_ticks}) {}

void WindowCache::make_holes(const TickSet& holes, TickRange ticks) {
  for (const TickRange& changed : differing(holes, inside(holes_, ticks))) sums_.forget(changed);
  TickSet all = outside(holes_, ticks);
  all.insert(all.end(), holes.begin(), holes.end());
  holes_ = identification::united(std::move(all));
}

std::variant<WindowData, UnknownParameter> WindowCache::load(
    const storage::Archive& archive, storage::TimeRange window,
    const std::optional<WantedPart>& wanted) {
  const CachingReader reader(archive);
  auto described = describe_window(reader, request_);
  if (const auto* unknown = std::get_if<UnknownParameter>(&described)) return *unknown;
  WindowData data = std::get<WindowData>(std::move(described));
  std::vector<Channel> channels = data.input_channels;
  channels.insert(channels.end(), data.output_channels.begin(), data.output_channels.end());
  if (channels != channels_) {
    samples_.clear();
    sums_ = identification::LagSums(sums_.shape());
    channels_ = std::move(channels);
  }

  const TickRange ticks = ticks_of(window, request_.period);
  constexpr std::int64_t earliest = std::numeric_limits<std::int64_t>::min();
  const std::int64_t first_chunk = floor_divide(ticks.begin, ChunkCache::chunk_ticks);
  const TickRange past{earliest, first_chunk * ChunkCache::chunk_ticks};
  sums_.forget(past);
  holes_ = outside(holes_, past);
  Record samples = samples_.over(ticks, [&](TickRange missing) {
    ticks_read_ += missing.end - missing.begin;
    return load_samples(reader, request_, data,
                        {missing.begin * request_.period, missing.end * request_.period});
  });
  data.plausibility = checks_.look(reader, data, samples, ticks);
  make_holes(inside(data.plausibility.holes, ticks), ticks);
  InputExpressions expressions(request_.inputs, request_.derived);
  if (wanted) {
    window = {wanted->ticks.begin * request_.period, wanted->ticks.end * request_.period};
    for (const std::string& sensor : wanted->sensors)
      data.bias_effects.push_back(
          without(bias_effect(request_, data.input_channels, samples, sensor, wanted->ticks),
                  data.plausibility.holes));
    samples = rows_at(samples, wanted->ticks);
  }
  Record read = expressions.evaluate(std::move(samples));
  data.read_coverage = coverage_of(read, window, request_.period);
  data.record = without(std::move(read), data.plausibility.holes);
  data.coverage = coverage_of(data.record, window, request_.period);
  return data;
}

void WindowCache::forget(storage::TimeRange range) {
  // A sample serves the ticks until it is too old.
  using Limits = std::numeric_limits<storage::Time>;
  const storage::Time earliest = Limits::min() + request_.phase;
  const storage::Time latest = Limits::max() - request_.sample_hold;
  const TickRange ticks =
      ticks_of({std::max(range.begin, earliest) - request_.phase,
                std::min(range.end, latest) + request_.sample_hold - request_.phase},
               request_.period);
  samples_.forget(ticks);
  checks_.forget(ticks);
  sums_.forget(ticks);
}

}  // namespace reident
