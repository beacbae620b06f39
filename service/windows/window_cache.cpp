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

/// WindowData::bias_effects of a bias, in its unit, of the sensor at `place` of `samples`; 0: it
/// has no effect. Where the sensor without it would give an input that is not finite, it counts as
/// far as that is finite; where most of the bias does not, in the mean of such rows, the sensor
/// does not have it. `inputs` are those of the samples that have any.
Record bias_effect(InputExpressions& expressions, Index place, double bias, const Record& samples,
                   const Record& inputs) {
  constexpr double least_step = 1e-5;
  Record effect{inputs.period_s, Matrix::Zero(inputs.rows(), inputs.u.cols()),
                Matrix(inputs.rows(), 1), inputs.segments};
  const std::vector<Index> moved = expressions.inputs_of(place);
  Vector raw(samples.u.cols()), without(std::ssize(moved));
  double impossible = 0, limited = 0;  // parts of the bias, over it, and rows
  for (const identification::Segment& segment : inputs.segments) {
    Index from = first_row_at(samples, segment.first_tick);
    for (Index row = segment.begin; row < segment.end; ++row, ++from) {
      effect.y(row, 0) = samples.u(from, place);
      if (bias == 0) continue;
      raw = samples.u.row(from).transpose();
      const auto is_finite_without = [&](double part) {
        raw(place) = samples.u(from, place) - part;
        for (std::size_t i = 0; i < moved.size(); ++i)
          without(Index(i)) = expressions.evaluate(raw, moved[i]);
        return without.allFinite();
      };
      if (!is_finite_without(bias)) {
        double part = 0;
        for (double step = bias / 2; std::abs(step) > least_step * std::abs(bias); step /= 2)
          if (is_finite_without(part + step)) part += step;
        is_finite_without(part);
        impossible += 1 - part / bias;
        ++limited;
      }
      for (std::size_t i = 0; i < moved.size(); ++i)
        effect.u(row, moved[i]) = (inputs.u(row, moved[i]) - without(Index(i))) / bias;
    }
  }
  if (impossible > most * limited) effect.u.setZero();
  return effect;
}

/// Deviation of each sensor's values.
std::vector<double> deviations_of(const Record& samples) {
  std::vector<double> deviations(static_cast<std::size_t>(samples.u.cols()), 0);
  for (Index place = 0; samples.rows() > 0 && place < samples.u.cols(); ++place) {
    const auto values = samples.u.col(place).array();
    deviations[static_cast<std::size_t>(place)] =
        std::sqrt((values - values.mean()).square().mean());
  }
  return deviations;
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
  data.outputs_move =
      samples.rows() > 0 && samples.y != samples.y.row(0).replicate(samples.rows(), 1);
  InputExpressions expressions(request_.inputs, request_.derived);
  std::vector<std::pair<Index, double>> biases;  // places and sizes; 0: none
  if (wanted) {
    window = {wanted->ticks.begin * request_.period, wanted->ticks.end * request_.period};
    const std::vector<double> deviations = deviations_of(samples);
    for (const SensorBias& bias : wanted->biases) {
      const auto sensor = std::ranges::find(expressions.parameters(), bias.sensor);
      const auto place = static_cast<std::size_t>(sensor - expressions.parameters().begin());
      biases.emplace_back(
          place, data.input_channels[place].is_analog ? size_of(bias, deviations[place]) : 0);
    }
    samples = rows_at(samples, wanted->ticks);
  }
  Record read = expressions.evaluate(wanted ? Record(samples) : std::move(samples));
  for (const auto& [place, bias] : biases)
    data.bias_effects.push_back(
        without(bias_effect(expressions, place, bias, samples, read), data.plausibility.holes));
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
