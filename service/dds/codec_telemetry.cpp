#include <algorithm>
#include <span>

#include "service/dds/codec.hpp"

namespace reident::dds {
namespace {

using storage::TelemetryFrame;

bool may_be_sent(std::uint8_t number) {
  const auto quality = storage::quality_of_wire(number);
  return quality && facts(*quality).is_sent;
}

/// The greatest number of those that a frame may have.
constexpr std::uint8_t last_sent_quality() {
  std::uint8_t last = 0;
  for (const storage::QualityFacts& row : storage::quality_table)
    if (row.is_sent) last = row.wire;
  return last;
}

/// The sizes and the numbers that stand for enumerators; the samples' values are free.
Fault fault_in_samples(const satcs_TelemetryFrame& wire, const ReaderOptions& options) {
  const std::uint32_t count = wire.parameter._length;
  if (wire.value._length != count || wire.quality._length != count) {
    return "the frame has " + std::to_string(count) + " parameters, " +
           std::to_string(wire.value._length) + " values and " +
           std::to_string(wire.quality._length) + " qualities; send one of each for a sample";
  }
  if (count > options.max_frame_samples) {
    return "the frame has " + std::to_string(count) + " samples and at most " +
           std::to_string(options.max_frame_samples) + " are accepted; split it";
  }
  const std::span<const std::uint8_t> qualities(wire.quality._buffer, count);
  const auto unknown = std::find_if_not(qualities.begin(), qualities.end(), may_be_sent);
  if (unknown != qualities.end()) {
    return "sample " + std::to_string(unknown - qualities.begin()) + " has quality " +
           std::to_string(*unknown) + "; the last that is known is " +
           std::to_string(last_sent_quality());
  }
  if (wire.origin > satcs_ORIGIN_SIMULATED) {
    return "the origin is " + std::to_string(wire.origin) + "; send 0 (real) or 1 (simulated)";
  }
  return std::nullopt;
}

}  // namespace

const satcs_TelemetryFrame& Codec<TelemetryFrame>::Encoder::operator()(
    const TelemetryFrame& frame) {
  const std::size_t count = frame.samples.size();
  parameter_.resize(count);
  value_.resize(count);
  quality_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    parameter_[i] = frame.samples[i].parameter;
    value_[i] = frame.samples[i].value;
    quality_[i] = storage::wire_value(frame.samples[i].quality);
  }
  wire_.spacecraft = borrow(frame.spacecraft);
  wire_.source = borrow(frame.source);
  wire_.origin = static_cast<std::uint8_t>(frame.origin);
  wire_.sequence_number = frame.sequence;
  wire_.generation_time_ns = frame.generation_time;
  wire_.reception_time_ns = frame.reception_time;
  wire_.parameter = borrow<dds_sequence_uint32>(parameter_);
  wire_.value = borrow<dds_sequence_double>(value_);
  wire_.quality = borrow<dds_sequence_octet>(quality_);
  wire_.first_sequence_number = frame.first_sequence;
  return wire_;
}

Fault Codec<TelemetryFrame>::decode(const satcs_TelemetryFrame& wire, const ReaderOptions& options,
                                    TelemetryFrame& frame) {
  TextReader texts;
  frame.spacecraft = texts.name(wire.spacecraft, "spacecraft");
  frame.source = texts.name(wire.source, "source");
  frame.sequence = wire.sequence_number;
  frame.first_sequence = wire.first_sequence_number;
  frame.generation_time = wire.generation_time_ns;
  frame.reception_time = wire.reception_time_ns;
  if (texts.fault()) return texts.fault();
  if (Fault fault = fault_in_samples(wire, options)) return fault;
  frame.origin = static_cast<storage::Origin>(wire.origin);
  frame.samples.resize(wire.parameter._length);
  for (std::size_t i = 0; i < frame.samples.size(); ++i) {
    frame.samples[i] = {wire.parameter._buffer[i],
                        *storage::quality_of_wire(wire.quality._buffer[i]), wire.value._buffer[i]};
  }
  return std::nullopt;
}

}  // namespace reident::dds
