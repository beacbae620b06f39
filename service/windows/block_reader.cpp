#include "service/windows/block_reader.hpp"

#include <algorithm>
#include <utility>

#include "service/windows/telemetry_checks.hpp"
#include "service/windows/window_data.hpp"

namespace reident {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Record;

/// With more sensor faults found in a tick, others that are too small to be found spoil the scores.
constexpr double most_faults = 1.0 / 400;

Duration checked_before(Duration block) {
  return cycles_before * blocks_of_cycle * block;
}

/// Mean squared difference of the outputs at the ticks that both have.
std::vector<double> mean_squared_difference(const Record& one, const Record& other) {
  identification::Vector squares = identification::Vector::Zero(one.y.cols());
  Index rows = 0;
  for (const identification::Segment& a : one.segments)
    for (const identification::Segment& b : other.segments) {
      const std::int64_t begin = std::max(a.first_tick, b.first_tick);
      const std::int64_t end = std::min(a.end_tick(), b.end_tick());
      if (begin >= end) continue;
      const Index count = end - begin;
      squares += (one.y.middleRows(a.begin + (begin - a.first_tick), count) -
                  other.y.middleRows(b.begin + (begin - b.first_tick), count))
                     .colwise()
                     .squaredNorm()
                     .transpose();
      rows += count;
    }
  if (2 * rows < one.rows() || rows == 0) return {};
  return list(squares / static_cast<double>(rows));
}

}  // namespace

std::vector<double> list(const identification::Vector& values) {
  return {values.begin(), values.end()};
}

Duration block_length(const EquipmentConfig& equipment) {
  const Duration ticks = equipment.cycle / blocks_of_cycle / equipment.sample_period;
  return std::max<Duration>(1, ticks) * equipment.sample_period;
}

Duration checked_before_block(const EquipmentConfig& equipment) {
  return checked_before(block_length(equipment));
}

BlockReader::BlockReader(const std::string& spacecraft, const EquipmentConfig& equipment)
    : length_(block_length(equipment)),
      telemetry_(request_of(spacecraft, equipment), 1, checks_of(equipment)),
      biases_(biases_of(telemetry_.request().inputs, telemetry_.request().derived)) {}

bool BlockReader::reads(storage::Time begin, storage::TimeRange range) const {
  // A sample serves the ticks from `phase` before it on, until it is too old.
  const WindowRequest& request = telemetry_.request();
  return range.begin < begin + length_ + request.phase &&
         range.end > begin - checked_before(length_) - request.sample_hold;
}

std::vector<double> BlockReader::baseline(const storage::Archive& archive,
                                          const BlockSamples& samples,
                                          storage::TimeRange range) const {
  WindowRequest request = telemetry_.request();
  request.inputs.clear();
  request.derived.clear();
  request.origin = storage::Origin::simulated;
  const auto loaded = load_window(archive, request, range);
  const auto* data = std::get_if<WindowData>(&loaded);
  if (!data || data->record.rows() == 0) return {};
  const Record own = rows_at(samples.record, ticks_of(range, request.period));
  return mean_squared_difference(own, data->record);
}

BlockSamples BlockReader::read(const storage::Archive& archive, storage::Time begin) {
  const Duration period = telemetry_.request().period;
  BlockSamples samples;
  samples.block.range = {begin, begin + length_};
  std::variant<WindowData, UnknownParameter> loaded = UnknownParameter{};
  try {
    const storage::TimeRange checked{begin - checked_before(length_), begin + length_};
    const auto wanted = ticks_of({begin - length_, begin + length_}, period);
    loaded = telemetry_.load(archive, checked, WantedPart{wanted, biases_});
    auto* data = std::get_if<WindowData>(&loaded);
    if (!data) return samples;
    samples.record = std::move(data->record);
    samples.bias_effects = std::move(data->bias_effects);
    samples.first_row = first_row_at(samples.record, ticks_of(samples.block.range, period).begin);
    const Index rows = samples.record.rows() - samples.first_row;
    if (rows <= 0) return samples;
    const Matrix u = samples.record.u.bottomRows(rows), y = samples.record.y.bottomRows(rows);
    storage::Block& block = samples.block;
    block.rows = rows;
    if (data->outputs_move &&
        fault_share(data->plausibility, ticks_of(checked, period)) <= most_faults)
      block.believed = static_cast<double>(rows) / static_cast<double>(length_ / period);
    block.output_mean = list(y.colwise().mean().transpose());
    block.output_square = list(y.cwiseAbs2().colwise().mean().transpose());
    block.input_low = list(u.colwise().minCoeff().transpose());
    block.input_high = list(u.colwise().maxCoeff().transpose());
    block.baseline_square = baseline(archive, samples, block.range);
  } catch (const storage::Error& error) {
    if (error.kind() != storage::Error::Kind::corrupt) throw;
    samples = {};
    samples.block.range = {begin, begin + length_};
  }
  return samples;
}

}  // namespace reident
