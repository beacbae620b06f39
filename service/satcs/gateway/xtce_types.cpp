#include <algorithm>
#include <cmath>
#include <limits>

#include "service/satcs/gateway/xtce_context.hpp"

namespace reident::satcs::xtce {
namespace {

/// Reads one type; what it does not know becomes a note.
class TypeReader {
 public:
  TypeReader(Context& context, const std::string& space, ParameterType& type)
      : context_(context), space_(space), type_(type) {}

  void read(const XmlElement& element);

 private:
  void read_time_scale(const XmlElement& element);
  void read_labels(const XmlElement& element);
  void read_units(const XmlElement& element);
  void read_alarm(const XmlElement& element);
  Range read_range(const XmlElement& element);

  Context& context_;
  const std::string& space_;
  ParameterType& type_;
};

void TypeReader::read(const XmlElement& element) {
  type_.description = element.attribute("shortDescription").value_or("");
  if (type_.kind == Kind::boolean) {
    type_.labels = {{0, 0, element.attribute("zeroStringValue").value_or("False")},
                    {1, std::numeric_limits<std::int64_t>::max(),
                     element.attribute("oneStringValue").value_or("True")}};
  }
  for (const XmlElement& child : element.children()) {
    if (child.name().ends_with("DataEncoding")) read_encoding(context_, child, space_, type_);
    if (child.name() == "Encoding") read_time_scale(child);
    if (child.name() == "EnumerationList") read_labels(child);
    if (child.name() == "UnitSet") read_units(child);
    if (child.name() == "DefaultAlarm") read_alarm(child);
    if (child.name() == "ValidRange") {
      type_.valid = read_range(child);
      type_.valid_is_calibrated = child.attribute("validRangeAppliesToCalibrated") != "false";
    }
  }
  if (element.attribute("baseType"))
    context_.give_up(element, type_, "a type that is made of another one (baseType) is not known");
  context_.note_others(
      element,
      {"IntegerDataEncoding", "FloatDataEncoding", "StringDataEncoding", "BinaryDataEncoding",
       "Encoding", "EnumerationList", "UnitSet", "DefaultAlarm", "ValidRange", "MemberList",
       "SizeRangeInCharacters", "ToString"},
      "it is not used");
}

// The encoding of a time, whose value is a number of units since its epoch.
void TypeReader::read_time_scale(const XmlElement& element) {
  type_.unit = element.attribute("units").value_or("s");
  if (type_.unit == "seconds") type_.unit = "s";
  for (const XmlElement& child : element.children()) read_encoding(context_, child, space_, type_);
  if (type_.encoding)
    type_.encoding->calibrator.coefficients = {context_.number(element, "offset", 0),
                                               context_.number(element, "scale", 1)};
}

void TypeReader::read_labels(const XmlElement& element) {
  for (const XmlElement& one : element.children()) {
    const auto low = whole_number(one.attribute("value").value_or(""));
    const auto high = one.attribute("maxValue") ? whole_number(*one.attribute("maxValue")) : low;
    if (low && high && *low <= *high)
      type_.labels.push_back({*low, *high, one.attribute("label").value_or("")});
    else
      context_.note(one, "a state without a whole number as its value is left out");
  }
}

void TypeReader::read_units(const XmlElement& element) {
  for (const XmlElement& unit : element.children()) {
    std::string text = unit.text();
    const std::string power = unit.attribute("power").value_or("1");
    if (power != "1" && !text.empty()) text += "^" + power;
    if (const auto factor = unit.attribute("factor"); factor && *factor != "1")
      text = *factor + " " + text;
    type_.unit += (type_.unit.empty() || text.empty() ? "" : " ") + text;
  }
}

Range TypeReader::read_range(const XmlElement& element) {
  const Range none;
  Range range;
  range.low =
      std::max(context_.number(element, "minInclusive", none.low),
               std::nextafter(context_.number(element, "minExclusive", none.low), none.high));
  if (!element.attribute("minInclusive") && !element.attribute("minExclusive"))
    range.low = none.low;
  range.high =
      std::min(context_.number(element, "maxInclusive", none.high),
               std::nextafter(context_.number(element, "maxExclusive", none.high), none.low));
  if (!element.attribute("maxInclusive") && !element.attribute("maxExclusive"))
    range.high = none.high;
  return range;
}

// A value outside of any of the ranges is out of limits.
void TypeReader::read_alarm(const XmlElement& element) {
  for (const XmlElement& kind : element.children()) {
    if (kind.name() != "StaticAlarmRanges" || kind.attribute("rangeForm") == "inside") {
      context_.note(kind, "an alarm of this kind is not used");
      continue;
    }
    for (const XmlElement& range : kind.children()) {
      if (!range.name().ends_with("Range")) continue;
      const Range one = read_range(range);
      type_.alarm_free.low = std::max(type_.alarm_free.low, one.low);
      type_.alarm_free.high = std::min(type_.alarm_free.high, one.high);
    }
    if (type_.alarm_free.low > type_.alarm_free.high) {
      context_.note(kind, "its ranges have nothing in common; they are not used");
      type_.alarm_free = {};
    }
  }
}

}  // namespace

void read_type(Context& context, const XmlElement& element, const std::string& space,
               ParameterType& type) {
  TypeReader(context, space, type).read(element);
}

}  // namespace reident::satcs::xtce
