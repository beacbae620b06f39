#include <algorithm>
#include <cmath>
#include <limits>

#include "service/satcs/gateway/xtce_context.hpp"

namespace reident::satcs::xtce {
namespace {

constexpr double highest_exponent = 32;
constexpr std::uint64_t most_bits = std::uint64_t{8} << 16;  // of a space packet

/// Reads the encoding of one type; where it is not known, the type is not usable.
class EncodingReader {
 public:
  EncodingReader(Context& context, const std::string& space, ParameterType& type)
      : context_(context), space_(space), type_(type) {}

  void read(const XmlElement& element);

 private:
  void read_integer(const XmlElement& element, Encoding& encoding);
  void read_float(const XmlElement& element, Encoding& encoding);
  void read_text(const XmlElement& element, Encoding& encoding);
  void read_binary(const XmlElement& element, Encoding& encoding);
  void read_byte_order(const XmlElement& element, Encoding& encoding);
  void read_calibrators(const XmlElement& element, Encoding& encoding);
  Calibrator read_calibrator(const XmlElement& element);
  void read_polynomial(const XmlElement& element, Calibrator& calibrator);
  void read_spline(const XmlElement& element, Calibrator& calibrator);

  Context& context_;
  const std::string& space_;
  ParameterType& type_;
};

void EncodingReader::read(const XmlElement& element) {
  Encoding encoding;
  if (element.name() == "IntegerDataEncoding")
    read_integer(element, encoding);
  else if (element.name() == "FloatDataEncoding")
    read_float(element, encoding);
  else if (element.name() == "StringDataEncoding")
    read_text(element, encoding);
  else if (element.name() == "BinaryDataEncoding")
    read_binary(element, encoding);
  else
    return context_.give_up(element, type_, "an encoding that is not known");
  if (encoding.size.bits > most_bits)
    return context_.give_up(element, type_, "a field that is larger than a packet");
  const bool is_number = encoding.coding != Coding::text && encoding.coding != Coding::binary;
  const bool needs_number = type_.kind != Kind::text && type_.kind != Kind::binary;
  if (is_number != needs_number)
    context_.give_up(element, type_, "the encoding does not go with the type");
  type_.encoding = std::move(encoding);
}

void EncodingReader::read_byte_order(const XmlElement& element, Encoding& encoding) {
  const std::string order = element.attribute("byteOrder").value_or("mostSignificantByteFirst");
  encoding.low_byte_first = order == "leastSignificantByteFirst";
  if (!encoding.low_byte_first && order != "mostSignificantByteFirst")
    context_.give_up(element, type_, "byteOrder '" + order + "' is not known");
  encoding.low_bit_first = element.attribute("bitOrder") == "leastSignificantBitFirst";
  if (const auto list = element.child("ByteOrderList"))
    context_.give_up(*list, type_, "an order of bytes of its own is not known");
}

void EncodingReader::read_integer(const XmlElement& element, Encoding& encoding) {
  const std::string coding = element.attribute("encoding").value_or("unsigned");
  if (coding == "unsigned")
    encoding.coding = Coding::unsigned_integer;
  else if (coding == "twosComplement" || coding == "twosCompliment")  // so in XTCE 1.1
    encoding.coding = Coding::twos_complement;
  else if (coding == "onesComplement" || coding == "onesCompliment")
    encoding.coding = Coding::ones_complement;
  else if (coding == "signMagnitude")
    encoding.coding = Coding::sign_magnitude;
  else
    context_.give_up(element, type_, "the encoding '" + coding + "' is not known");
  const double bits = context_.number(element, "sizeInBits", 8);
  encoding.size.bits = bits >= 0 && bits <= static_cast<double>(most_bits)
                           ? static_cast<std::uint64_t>(bits)
                           : most_bits + 1;
  if (bits < 1 || bits > 64) context_.give_up(element, type_, "an integer has 1 to 64 bits");
  read_byte_order(element, encoding);
  read_calibrators(element, encoding);
}

void EncodingReader::read_float(const XmlElement& element, Encoding& encoding) {
  const std::string coding = element.attribute("encoding").value_or("IEEE754_1985");
  const double bits = context_.number(element, "sizeInBits", 32);
  const bool is_ieee = coding == "IEEE754" || coding == "IEEE754_1985";
  const bool is_mil = coding == "MILSTD_1750A";
  encoding.coding = is_mil ? Coding::mil_std_1750a : Coding::ieee754;
  encoding.size.bits = bits >= 0 && bits <= 128 ? static_cast<std::uint64_t>(bits) : most_bits + 1;
  if (!(is_ieee && (bits == 16 || bits == 32 || bits == 64)) &&
      !(is_mil && (bits == 32 || bits == 48)))
    context_.give_up(element, type_,
                     "a float of encoding '" + coding + "' with this size is not known");
  read_byte_order(element, encoding);
  read_calibrators(element, encoding);
}

void EncodingReader::read_text(const XmlElement& element, Encoding& encoding) {
  encoding.coding = Coding::text;
  auto where = element.child("SizeInBits");
  const bool is_fixed = where.has_value();
  if (!where) where = element.child("Variable");
  if (!where) return context_.give_up(element, type_, "a text without a size");
  if (const auto size = where->child("Fixed"))
    encoding.size = read_size(context_, *size, space_).value_or(FieldSize{});
  else if (where->child("DynamicValue"))
    encoding.size = read_size(context_, *where, space_).value_or(FieldSize{});
  if (const auto end = where->child("TerminationChar")) {
    const auto value = whole_number("0x" + end->text());
    if (value && *value >= 0 && *value <= 255)
      encoding.terminator = static_cast<std::uint8_t>(*value);
    else
      context_.give_up(*end, type_, "a text ends with one byte, such as 00");
  }
  if (const auto leading = where->child("LeadingSize"))
    encoding.length_bits = static_cast<std::uint32_t>(
        std::clamp(context_.number(*leading, "sizeInBitsOfSizeTag", 16), 1.0, 32.0));
  if (is_fixed && encoding.size.bits == 0 && !encoding.size.of && !encoding.terminator &&
      encoding.length_bits == 0)
    context_.give_up(element, type_, "a text without a size");
}

void EncodingReader::read_binary(const XmlElement& element, Encoding& encoding) {
  encoding.coding = Coding::binary;
  const auto size = element.child("SizeInBits");
  const auto read = size ? read_size(context_, *size, space_) : std::nullopt;
  if (!size) context_.note(element, "a field without a size; what follows it has no known place");
  if (read) encoding.size = *read;
  if (!read) type_.is_usable = false;
}

void EncodingReader::read_calibrators(const XmlElement& element, Encoding& encoding) {
  if (const auto calibrator = element.child("DefaultCalibrator"))
    encoding.calibrator = read_calibrator(*calibrator);
  if (const auto list = element.child("ContextCalibratorList")) {
    for (const XmlElement& one : list->children()) {
      const auto match = one.child("ContextMatch");
      const auto calibrator = one.child("Calibrator");
      auto when = match ? read_condition(context_, *match, space_) : std::nullopt;
      if (when && calibrator)
        encoding.context_calibrators.push_back({*std::move(when), read_calibrator(*calibrator)});
      else
        context_.give_up(one, type_, "a calibrator without a condition that is known");
    }
  }
  context_.note_others(element, {"DefaultCalibrator", "ContextCalibratorList", "ByteOrderList"},
                       "it is not used");
}

Calibrator EncodingReader::read_calibrator(const XmlElement& element) {
  Calibrator calibrator;
  for (const XmlElement& child : element.children()) {
    if (child.name() == "PolynomialCalibrator")
      read_polynomial(child, calibrator);
    else if (child.name() == "SplineCalibrator")
      read_spline(child, calibrator);
    else if (child.name() != "AncillaryDataSet")
      context_.give_up(child, type_, "a calibrator that is not known");
  }
  return calibrator;
}

void EncodingReader::read_polynomial(const XmlElement& element, Calibrator& calibrator) {
  for (const XmlElement& term : element.children()) {
    const double exponent = context_.number(term, "exponent", 0);
    if (exponent < 0 || exponent > highest_exponent || exponent != std::floor(exponent)) {
      context_.give_up(term, type_, "an exponent is a whole number from 0 to 32");
      continue;
    }
    const auto place = static_cast<std::size_t>(exponent);
    if (calibrator.coefficients.size() <= place) calibrator.coefficients.resize(place + 1);
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    const double coefficient = context_.number(term, "coefficient", nothing);
    if (std::isnan(coefficient)) context_.give_up(term, type_, "a term without a coefficient");
    calibrator.coefficients[place] += coefficient;
  }
}

void EncodingReader::read_spline(const XmlElement& element, Calibrator& calibrator) {
  const double order = context_.number(element, "order", 1);
  if (order != 0 && order != 1) context_.give_up(element, type_, "a spline is of order 0 or 1");
  calibrator.holds_between_points = order == 0;
  calibrator.extrapolates = element.attribute("extrapolate") == "true";
  const double nothing = std::numeric_limits<double>::quiet_NaN();
  for (const XmlElement& point : element.children())
    calibrator.points.emplace_back(context_.number(point, "raw", nothing),
                                   context_.number(point, "calibrated", nothing));
  auto& points = calibrator.points;
  const bool are_numbers = std::all_of(points.begin(), points.end(), [](const auto& point) {
    return std::isfinite(point.first) && std::isfinite(point.second);
  });
  if (!are_numbers) return context_.give_up(element, type_, "a point without raw or calibrated");
  std::sort(points.begin(), points.end());
  const bool are_apart =
      std::adjacent_find(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return a.first == b.first;
      }) == points.end();
  if (points.size() < 2 || !are_apart)
    context_.give_up(element, type_, "a spline has two points or more, each of another raw value");
}

}  // namespace

void read_encoding(Context& context, const XmlElement& element, const std::string& space,
                   ParameterType& type) {
  EncodingReader(context, space, type).read(element);
}

std::optional<FieldSize> read_size(Context& context, const XmlElement& element,
                                   const std::string& space) {
  if (const auto fixed = element.child("FixedValue")) {
    const auto bits = whole_number(fixed->text());
    if (bits && *bits >= 0) return FieldSize{.bits = static_cast<std::uint64_t>(*bits)};
    context.note(*fixed, "'" + fixed->text() + "' is no number of bits");
    return std::nullopt;
  }
  if (const auto dynamic = element.child("DynamicValue")) {
    const auto reference = dynamic->child("ParameterInstanceRef");
    const auto of = reference ? context.parameters.find(
                                    space, reference->attribute("parameterRef").value_or(""))
                              : std::nullopt;
    if (of) {
      FieldSize size{.of = of};
      if (const auto line = dynamic->child("LinearAdjustment")) {
        size.slope = context.number(*line, "slope", 0);
        size.intercept = context.number(*line, "intercept", 0);
      }
      return size;
    }
  }
  context.note(element, "a size of this kind is not known; what follows it has no known place");
  return std::nullopt;
}

}  // namespace reident::satcs::xtce
