#include "service/satcs/gateway/packet_stream.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "service/satcs/parameter_id.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

constexpr storage::Time day = 86'400 * storage::second_ns;
constexpr storage::Time earliest = 7'305 * day;  // 1990-01-01
constexpr std::size_t longest_states = 2000;     // bytes of a description

std::string states_text(const std::vector<xtce::Label>& labels) {
  std::string text;
  for (const xtce::Label& label : labels) {
    text += fmt::format("{}{}={}", text.empty() ? "states " : ", ", label.text, label.low);
    if (text.size() > longest_states) return text + ", ...";
  }
  return text;
}

storage::ParameterDescriptor descriptor_of(const xtce::Parameter& parameter,
                                           const xtce::ParameterType& type) {
  storage::ParameterDescriptor descriptor;
  descriptor.id = parameter_id(parameter.name);
  descriptor.name = parameter.name;
  descriptor.unit = type.unit;
  descriptor.description = !parameter.description.empty() ? parameter.description
                           : !type.description.empty()    ? type.description
                                                          : parameter.path;
  if (!type.labels.empty()) {
    descriptor.kind = storage::ParameterKind::digital;
    descriptor.description = states_text(type.labels) + "; " + descriptor.description;
  }
  if (std::isfinite(type.alarm_free.low)) descriptor.low_limit = type.alarm_free.low;
  if (std::isfinite(type.alarm_free.high)) descriptor.high_limit = type.alarm_free.high;
  return descriptor;
}

}  // namespace

std::variant<std::vector<GatewayParameter>, csv::Error> gateway_parameters(
    const xtce::Database& database, const std::vector<std::string>& only) {
  std::vector<GatewayParameter> chosen;
  std::vector<std::string> left = only;
  std::map<std::uint32_t, std::string> seen;
  for (const xtce::Index index : database.published) {
    const xtce::Parameter& parameter = database.parameters[index];
    const bool is_named = std::find(only.begin(), only.end(), parameter.name) != only.end();
    if (!is_named && (!only.empty() || database.identifying.contains(index))) continue;
    std::erase(left, parameter.name);
    chosen.push_back({index, descriptor_of(parameter, database.types[parameter.type])});
    const auto [other, is_new] = seen.emplace(chosen.back().descriptor.id, parameter.name);
    if (!is_new)
      return csv::Error{
          fmt::format("parameters '{}' and '{}' would have one id; leave one out by "
                      "--only",
                      other->second, parameter.name)};
  }
  if (!left.empty())
    return csv::Error{
        fmt::format("no packet of the database brings a number '{}'; --list shows "
                    "those that come",
                    left.front())};
  if (chosen.empty())
    return csv::Error{"the database has no parameter with numbers in a packet; --check says why"};
  return chosen;
}

PacketStream::PacketStream(const xtce::Database& database, std::vector<GatewayParameter> parameters,
                           PacketOptions options, std::unique_ptr<PacketSource> source,
                           Sender sender, Clock clock, std::stop_token stop)
    : database_(database),
      parameters_(std::move(parameters)),
      ids_(database.parameters.size()),
      options_(std::move(options)),
      source_(std::move(source)),
      sender_(std::move(sender)),
      clock_(std::move(clock)),
      stop_(std::move(stop)),
      splitter_(options_.prefix_bytes,
                [this](const char* reason, std::uint64_t offset, std::size_t bytes) {
                  counts_.leave_out(reason, offset, bytes, {});
                }),
      decoder_(database),
      next_sequence_(sender_.first_sequence) {
  for (const GatewayParameter& one : parameters_) ids_[one.index] = one.descriptor.id;
}

std::vector<storage::ParameterDescriptor> PacketStream::parameters() const {
  std::vector<storage::ParameterDescriptor> descriptors;
  for (const GatewayParameter& one : parameters_) descriptors.push_back(one.descriptor);
  return descriptors;
}

bool PacketStream::next(storage::TelemetryFrame& frame) {
  while (!stop_.stop_requested()) {
    if (const auto packet = splitter_.next(); !packet.empty()) {
      if (take(packet, frame)) return true;
      continue;
    }
    if (is_at_end_) return false;
    switch (source_->read(bytes_)) {
      case PacketSource::Got::bytes:
        splitter_.add(bytes_);
        break;
      case PacketSource::Got::whole:
        splitter_.add(bytes_);
        splitter_.end();
        break;
      case PacketSource::Got::nothing:
        break;
      case PacketSource::Got::end:
        splitter_.end();
        is_at_end_ = true;
        break;
    }
  }
  return false;
}

bool PacketStream::take(std::span<const std::uint8_t> packet, storage::TelemetryFrame& frame) {
  const PacketHeader header = packet_header(packet);
  if (header.is_command) return leave_out("command", packet, {}), false;
  next_sequence_ += counts_.add(header, splitter_.offset());
  if (header.apid == idle_apid) return false;
  const std::string apid = fmt::format("APID {}", header.apid);
  if (!header.is_whole) return leave_out("segment", packet, apid), false;
  const DecodedPacket decoded = decoder_.decode(packet, samples_);
  if (decoded.outcome == DecodedPacket::Outcome::no_container)
    return leave_out("no_container", packet, apid), false;
  if (decoded.outcome == DecodedPacket::Outcome::too_short)
    return leave_out("too_short", packet, apid + ": " + decoded.detail), false;
  if (!find_time(packet, frame)) return false;
  if (decoded.bits_left > 0)
    counts_.add_rest(database_.containers[decoded.container].name, decoded.bits_left);
  frame.samples.clear();
  for (storage::Sample sample : samples_) {
    const auto& id = ids_[sample.parameter];
    if (!id) continue;
    sample.parameter = *id;
    frame.samples.push_back(sample);
  }
  frame.source = sender_.source;
  frame.origin = sender_.origin;
  frame.first_sequence = sender_.first_sequence;
  frame.sequence = next_sequence_++;
  return true;
}

bool PacketStream::find_time(std::span<const std::uint8_t> packet, storage::TelemetryFrame& frame) {
  const storage::Time now = clock_();
  if (options_.time.kind == TimeCode::Kind::reception) {
    frame.generation_time = frame.reception_time = now;
    return true;
  }
  const auto time = packet_time(packet, options_.time);
  const std::string apid = fmt::format("APID {}", packet_header(packet).apid);
  if (!time) return leave_out("no_time", packet, apid), false;
  if (!options_.force_times && (*time < earliest || *time > now + day))
    return leave_out("time_range", packet, apid + ": " + time_text(*time)), false;
  frame.generation_time = *time;
  frame.reception_time = source_->is_live() ? now : *time;
  return true;
}

void PacketStream::leave_out(const char* reason, std::span<const std::uint8_t> packet,
                             const std::string& detail) {
  counts_.leave_out(reason, splitter_.offset(), packet.size(), detail);
}

}  // namespace reident::satcs
