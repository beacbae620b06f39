#include "service/satcs/gateway/packet_decoder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "service/satcs/gateway/bit_field.hpp"
#include "service/support/csv.hpp"

namespace reident::satcs {
namespace {

using namespace xtce;

constexpr int deepest = 32;  // containers in each other

bool related(Operator op, const auto& left, const auto& right) {
  switch (op) {
    case Operator::equal:
      return left == right;
    case Operator::not_equal:
      return left != right;
    case Operator::less:
      return left < right;
    case Operator::at_most:
      return left <= right;
    case Operator::greater:
      return left > right;
    case Operator::at_least:
      return left >= right;
  }
  return false;
}

const Label* label_of(const ParameterType& type, std::int64_t raw) {
  for (const Label& one : type.labels)
    if (one.low <= raw && raw <= one.high) return &one;
  return nullptr;
}

double on_spline(const Calibrator& calibrator, double raw) {
  const auto& points = calibrator.points;
  const bool is_outside = raw < points.front().first || raw > points.back().first;
  if (is_outside && !calibrator.extrapolates) return std::numeric_limits<double>::quiet_NaN();
  auto right =
      std::upper_bound(points.begin(), points.end(), raw,
                       [](double value, const auto& point) { return value < point.first; });
  if (calibrator.holds_between_points)
    return right == points.begin() ? right->second : (right - 1)->second;
  right = std::clamp(right, points.begin() + 1, points.end() - 1);
  const auto left = right - 1;
  const double share = (raw - left->first) / (right->first - left->first);
  return left->second + share * (right->second - left->second);
}

}  // namespace

double calibrated(const Calibrator& calibrator, double raw) {
  if (!calibrator.points.empty()) return on_spline(calibrator, raw);
  if (calibrator.coefficients.empty()) return raw;
  double value = 0;
  for (auto term = calibrator.coefficients.rbegin(); term != calibrator.coefficients.rend(); ++term)
    value = value * raw + *term;
  return value;
}

PacketDecoder::PacketDecoder(const Database& database)
    : database_(database),
      is_published_(database.parameters.size()),
      values_(database.parameters.size()) {
  for (const Index one : database.published) is_published_[one] = true;
}

DecodedPacket PacketDecoder::decode(std::span<const std::uint8_t> packet,
                                    std::vector<storage::Sample>& samples) {
  packet_ = packet;
  samples_ = &samples;
  DecodedPacket best;
  for (const Index root : database_.roots) {
    samples.clear();
    ++packet_number_;
    DecodedPacket result;
    result.container = root;
    if (decode_from(database_.containers[root], result)) return result;
    if (best.outcome == DecodedPacket::Outcome::no_container) best = std::move(result);
  }
  return best;
}

bool PacketDecoder::decode_from(const Container& root, DecodedPacket& result) {
  Place place;
  const Container* container = &root;
  while (true) {
    if (!read_entries(*container, place)) {
      result.outcome = DecodedPacket::Outcome::too_short;
      result.detail = "container " + container->name + ": " + failure_;
      return false;
    }
    const Container* heir = heir_of(*container);
    if (heir == nullptr) break;
    container = heir;
    result.container = static_cast<Index>(heir - database_.containers.data());
  }
  result.bits_left = packet_.size() * 8 - std::min<std::uint64_t>(place.bit, packet_.size() * 8);
  result.outcome = container->is_abstract ? DecodedPacket::Outcome::no_container
                                          : DecodedPacket::Outcome::complete;
  return !container->is_abstract;
}

// One whose criteria hold, or else the one that has none.
const Container* PacketDecoder::heir_of(const Container& container) const {
  const Container* open = nullptr;
  for (const Index index : container.heirs) {
    const Container& heir = database_.containers[index];
    if (!heir.is_decidable) continue;
    if (!heir.criteria && open == nullptr) open = &heir;
    if (heir.criteria && holds(*heir.criteria)) return &heir;
  }
  return open;
}

bool PacketDecoder::read_entries(const Container& container, Place& place) {
  for (const Entry& entry : container.entries) {
    if (entry.when && !holds(*entry.when)) continue;
    const auto moved =
        static_cast<std::int64_t>(entry.location.from_begin ? place.begin : place.bit) +
        entry.location.bits;
    place.is_known = (place.is_known || entry.location.from_begin) && moved >= 0 &&
                     entry.what != Entry::What::unknown;
    if (!place.is_known) continue;
    place.bit = static_cast<std::uint64_t>(moved);
    const bool is_read = entry.what == Entry::What::parameter
                             ? read_parameter(entry.index, place)
                             : read_included(database_.containers[entry.index], place);
    if (!is_read) return false;
  }
  return true;
}

bool PacketDecoder::read_included(const Container& container, Place& place) {
  if (depth_ >= deepest) {
    failure_ = "containers are in each other without an end";
    return false;
  }
  ++depth_;
  Place inner{place.bit, place.bit, true};
  const bool is_read =
      (!container.base || read_included(database_.containers[*container.base], inner)) &&
      read_entries(container, inner);
  --depth_;
  place.bit = inner.bit;
  place.is_known = inner.is_known;
  return is_read;
}

bool PacketDecoder::fits(const Place& place, std::uint64_t bits, Index parameter) {
  const std::uint64_t there = packet_.size() * 8;
  if (place.bit <= there && bits <= there - place.bit) return true;
  failure_ = "parameter " + database_.parameters[parameter].name + " needs bits " +
             std::to_string(place.bit) + " to " + std::to_string(place.bit + bits) +
             ", there are " + std::to_string(there);
  return false;
}

std::optional<std::uint64_t> PacketDecoder::size_of(const FieldSize& size) const {
  if (!size.of) return size.bits;
  if (values_[*size.of].packet != packet_number_) return std::nullopt;
  const double bits = size.slope * values_[*size.of].raw + size.intercept;
  constexpr double most = 8.0 * 65'542;
  if (!(bits >= 0 && bits <= most)) return std::nullopt;
  return static_cast<std::uint64_t>(bits);
}

bool PacketDecoder::read_parameter(Index parameter, Place& place) {
  const Parameter& one = database_.parameters[parameter];
  const ParameterType& type = database_.types[one.type];
  if (type.kind == Kind::aggregate) {
    for (const Index member : one.members)
      if (place.is_known && !read_parameter(member, place)) return false;
    place.is_known = place.is_known && type.is_usable && !one.members.empty();
    return true;
  }
  const auto bits = type.encoding ? size_of(type.encoding->size) : std::nullopt;
  if (!bits) {
    place.is_known = false;
    return true;
  }
  if (!fits(place, *bits, parameter)) return false;
  Value& value = values_[parameter];
  value.packet = packet_number_;
  if (type.encoding->coding == Coding::text) {
    if (read_text(*type.encoding, place, value)) return true;
    failure_ = "the text " + one.name + " does not end within the packet";
    return false;
  }
  if (type.encoding->coding != Coding::binary && type.is_usable) {
    const RawNumber raw = number_of(packet_, place.bit, *type.encoding);
    value.raw = raw.value;
    value.raw_integer = raw.integer;
    calibrate(type, value);
    publish(parameter, type, value);
  }
  place.is_known = type.encoding->coding != Coding::binary || *bits > 0 || type.encoding->size.of;
  place.bit += *bits;
  return true;
}

// A text has a size of its own, or goes up to the terminator, or as long as a count before it says.
bool PacketDecoder::read_text(const Encoding& encoding, Place& place, Value& value) {
  const std::uint64_t there = packet_.size() * 8;
  const auto fixed = size_of(encoding.size).value_or(0);
  std::uint64_t bit = place.bit;
  std::uint64_t end = fixed > 0 ? place.bit + fixed : there;
  if (encoding.length_bits > 0) {
    if (end - bit < encoding.length_bits) return false;
    const std::uint64_t bytes = bits_of(packet_, bit, encoding.length_bits);
    bit += encoding.length_bits;
    if (bytes > (end - bit) / 8) return false;
    if (fixed == 0) end = bit + 8 * bytes;
  }
  value.text.clear();
  bool is_ended = false;
  for (; !is_ended && bit + 8 <= end; bit += 8) {
    const auto byte = static_cast<std::uint8_t>(bits_of(packet_, bit, 8));
    is_ended = encoding.terminator == byte;
    if (!is_ended) value.text += static_cast<char>(byte);
  }
  if (encoding.terminator && fixed == 0 && encoding.length_bits == 0 && !is_ended) return false;
  place.bit = fixed > 0 ? end : bit;
  return true;
}

void PacketDecoder::calibrate(const ParameterType& type, Value& value) const {
  value.calibrated = value.raw;
  if (type.kind == Kind::boolean) value.calibrated = value.raw != 0 ? 1 : 0;
  if (type.kind != Kind::integer && type.kind != Kind::real) return;
  const Calibrator* calibrator = &type.encoding->calibrator;
  for (const ContextCalibrator& one : type.encoding->context_calibrators) {
    if (!holds(one.when)) continue;
    calibrator = &one.calibrator;
    break;
  }
  value.calibrated = calibrated(*calibrator, value.raw);
}

void PacketDecoder::publish(Index parameter, const ParameterType& type, const Value& value) {
  if (!is_published_[parameter]) return;
  using storage::Quality;
  Quality quality = Quality::good;
  const double checked = type.valid_is_calibrated ? value.calibrated : value.raw;
  if (!std::isfinite(value.calibrated) || !type.valid.holds(checked))
    quality = Quality::invalid;
  else if (!type.labels.empty() && label_of(type, value.raw_integer) == nullptr)
    quality = Quality::suspect;
  else if (!type.alarm_free.holds(value.calibrated))
    quality = Quality::out_of_limits;
  const double number =
      std::isfinite(value.calibrated) ? value.calibrated : std::numeric_limits<double>::quiet_NaN();
  samples_->push_back({static_cast<std::uint32_t>(parameter), quality, number});
}

bool PacketDecoder::holds(const Condition& condition) const {
  const auto part_holds = [this](const Condition& part) { return holds(part); };
  switch (condition.kind) {
    case Condition::Kind::all:
      return std::all_of(condition.parts.begin(), condition.parts.end(), part_holds);
    case Condition::Kind::any:
      return std::any_of(condition.parts.begin(), condition.parts.end(), part_holds);
    case Condition::Kind::comparison:
      break;
  }
  return compare(condition);
}

// A parameter that did not come in this packet compares with nothing.
bool PacketDecoder::compare(const Condition& condition) const {
  const Value& value = values_[condition.parameter];
  if (value.packet != packet_number_) return false;
  const ParameterType& type = database_.types[database_.parameters[condition.parameter].type];
  if (type.kind == Kind::text) return related(condition.op, value.text, condition.value);
  if (condition.uses_calibrated && !type.labels.empty()) {
    const Label* label = label_of(type, value.raw_integer);
    for (const Label& one : type.labels)
      if (one.text == condition.value) return related(condition.op, label == &one, true);
  }
  const auto number = csv::to_number(condition.value);
  const double mine = condition.uses_calibrated ? value.calibrated : value.raw;
  return number && related(condition.op, mine, *number);
}

}  // namespace reident::satcs
