#include <cmath>

#include "service/dds/codec.hpp"

namespace reident::dds {

using storage::ParameterDescriptor;

const satcs_ParameterDescriptor& Codec<ParameterDescriptor>::Encoder::operator()(
    const ParameterDescriptor& parameter) {
  wire_.spacecraft = borrow(parameter.spacecraft);
  wire_.id = parameter.id;
  wire_.name = borrow(parameter.name);
  wire_.unit = borrow(parameter.unit);
  wire_.description = borrow(parameter.description);
  wire_.kind = static_cast<std::uint8_t>(parameter.kind);
  wire_.has_low_limit = parameter.low_limit.has_value();
  wire_.low_limit = parameter.low_limit.value_or(0);
  wire_.has_high_limit = parameter.high_limit.has_value();
  wire_.high_limit = parameter.high_limit.value_or(0);
  return wire_;
}

Fault Codec<ParameterDescriptor>::decode(const satcs_ParameterDescriptor& wire,
                                         const ReaderOptions& /*options*/,
                                         ParameterDescriptor& parameter) {
  TextReader texts;
  parameter.spacecraft = texts.name(wire.spacecraft, "spacecraft");
  parameter.id = wire.id;
  parameter.name = texts.name(wire.name, "name");
  parameter.unit = texts.text(wire.unit, "unit");
  parameter.description = texts.text(wire.description, "description");
  if (texts.fault()) return texts.fault();
  if (wire.kind > satcs_KIND_DIGITAL) {
    return parameter.name + " has kind " + std::to_string(wire.kind) +
           "; send 0 (analog) or 1 (digital)";
  }
  parameter.kind = static_cast<storage::ParameterKind>(wire.kind);
  if (wire.has_low_limit) parameter.low_limit = wire.low_limit;
  if (wire.has_high_limit) parameter.high_limit = wire.high_limit;
  const double low = parameter.low_limit.value_or(0);
  const double high = parameter.high_limit.value_or(0);
  if (!std::isfinite(low) || !std::isfinite(high)) {
    return parameter.name + " has a limit that is not a finite number; leave it out instead";
  }
  if (wire.has_low_limit && wire.has_high_limit && low > high) {
    return parameter.name + " has its low limit above its high limit";
  }
  return std::nullopt;
}

}  // namespace reident::dds
