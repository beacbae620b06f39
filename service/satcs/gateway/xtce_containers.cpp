#include <array>

#include "service/satcs/gateway/xtce_context.hpp"
#include "service/support/csv.hpp"

namespace reident::satcs::xtce {
namespace {

struct OperatorText {
  std::string_view text;
  Operator op;
};
constexpr std::array operators = {
    OperatorText{"==", Operator::equal},  OperatorText{"!=", Operator::not_equal},
    OperatorText{"<", Operator::less},    OperatorText{"<=", Operator::at_most},
    OperatorText{">", Operator::greater}, OperatorText{">=", Operator::at_least},
};

std::optional<Operator> operator_of(std::string_view text) {
  for (const OperatorText& one : operators)
    if (one.text == text) return one.op;
  return std::nullopt;
}

/// Compares the parameter that `reference` names with a value. Absent, with a note, where one is
/// missing.
std::optional<Condition> compared(Context& context, const XmlElement& reference,
                                  const std::string& space, const std::string& op,
                                  const std::optional<std::string>& value) {
  const std::string name = reference.attribute("parameterRef").value_or("");
  const auto parameter = context.parameters.find(space, name);
  const auto known = operator_of(op);
  if (!parameter) context.note(reference, "there is no parameter '" + name + "'");
  if (!known) context.note(reference, "the comparison '" + op + "' is not known");
  if (parameter && known && !value) context.note(reference, "a comparison without a value");
  if (reference.attribute("instance").value_or("0") != "0")
    context.note(reference, "a value of an earlier packet (instance) is not known");
  else if (parameter && known && value)
    return Condition{.kind = Condition::Kind::comparison,
                     .parameter = *parameter,
                     .op = *known,
                     .value = *value,
                     .uses_calibrated = reference.attribute("useCalibratedValue") != "false"};
  return std::nullopt;
}

std::optional<Condition> read_one(Context& context, const XmlElement& element,
                                  const std::string& space);

/// All children of `element` as one condition.
std::optional<Condition> read_parts(Context& context, const XmlElement& element,
                                    const std::string& space, Condition::Kind kind) {
  Condition whole{.kind = kind};
  for (const XmlElement& child : element.children()) {
    auto part = read_one(context, child, space);
    if (!part) return std::nullopt;
    whole.parts.push_back(*std::move(part));
  }
  return whole;
}

/// A Condition: a parameter, an operator and a value.
std::optional<Condition> read_comparison(Context& context, const XmlElement& element,
                                         const std::string& space) {
  const auto reference = element.child("ParameterInstanceRef");
  const auto op = element.child("ComparisonOperator");
  const auto value = element.child("Value");
  if (reference && op && value)
    return compared(context, *reference, space, op->text(), value->text());
  context.note(element, "a condition compares a parameter with a value; others are not known");
  return std::nullopt;
}

std::optional<Condition> read_one(Context& context, const XmlElement& element,
                                  const std::string& space) {
  const std::string_view name = element.name();
  if (name == "Comparison")
    return compared(context, element, space, element.attribute("comparisonOperator").value_or("=="),
                    element.attribute("value"));
  if (name == "Condition") return read_comparison(context, element, space);
  if (name == "ComparisonList" || name == "BooleanExpression" || name == "ANDedConditions")
    return read_parts(context, element, space, Condition::Kind::all);
  if (name == "ORedConditions") return read_parts(context, element, space, Condition::Kind::any);
  context.note(element, "a condition of this kind is not known");
  return std::nullopt;
}

std::optional<Location> read_location(Context& context, const XmlElement& element) {
  Location location;
  location.from_begin = element.attribute("referenceLocation") == "containerStart";
  const std::string from = element.attribute("referenceLocation").value_or("previousEntry");
  const auto fixed = element.child("FixedValue");
  const auto bits = fixed ? csv::to_number(fixed->text()) : std::nullopt;
  constexpr double most = 1e6;
  if (bits && *bits >= -most && *bits <= most && (location.from_begin || from == "previousEntry")) {
    location.bits = static_cast<std::int64_t>(*bits);
    return location;
  }
  context.note(element, "a place of this kind is not known; what follows it has none either");
  return std::nullopt;
}

/// What the entry refers to; unknown, with a note, where it is not there.
void read_reference(Context& context, const XmlElement& element, const std::string& space,
                    Entry& entry) {
  const bool is_parameter = element.name() == "ParameterRefEntry";
  const std::string name =
      element.attribute(is_parameter ? "parameterRef" : "containerRef").value_or("");
  const Names& names = is_parameter ? context.parameters : context.containers;
  if (const auto found = names.find(space, name)) {
    entry.what = is_parameter ? Entry::What::parameter : Entry::What::container;
    entry.index = *found;
  } else {
    context.note(element, "there is no '" + name + "'; what follows it has no known place");
  }
}

Entry read_entry(Context& context, const XmlElement& element, const std::string& space) {
  Entry entry;
  if (element.name() != "ParameterRefEntry" && element.name() != "ContainerRefEntry") {
    context.note(element, "an entry that is not known; what follows it has no known place");
    return entry;
  }
  read_reference(context, element, space, entry);
  for (const XmlElement& child : element.children()) {
    bool is_known = true;
    if (child.name() == "LocationInContainerInBits") {
      const auto location = read_location(context, child);
      is_known = location.has_value();
      entry.location = location.value_or(Location{});
    } else if (child.name() == "IncludeCondition") {
      entry.when = read_condition(context, child, space);
      is_known = entry.when.has_value();
    } else if (child.name() == "RepeatEntry") {
      context.note(child, "an entry that repeats is not known; what follows it has no known place");
      is_known = false;
    }
    if (!is_known) entry.what = Entry::What::unknown;
  }
  context.note_others(element, {"LocationInContainerInBits", "IncludeCondition", "RepeatEntry"},
                      "it is not used");
  return entry;
}

}  // namespace

std::optional<Condition> read_condition(Context& context, const XmlElement& element,
                                        const std::string& space) {
  return read_parts(context, element, space, Condition::Kind::all);
}

void read_container(Context& context, const XmlElement& element, const std::string& space,
                    Container& container) {
  if (const auto list = element.child("EntryList"))
    for (const XmlElement& entry : list->children())
      container.entries.push_back(read_entry(context, entry, space));
  if (const auto base = element.child("BaseContainer")) {
    const std::string name = base->attribute("containerRef").value_or("");
    container.base = context.containers.find(space, name);
    if (!container.base) {
      context.note(*base, "there is no container '" + name + "'; no packet is taken for this one");
      container.is_decidable = false;
    }
    if (const auto criteria = base->child("RestrictionCriteria")) {
      container.criteria = read_condition(context, *criteria, space);
      container.is_decidable = container.is_decidable && container.criteria.has_value();
    }
  }
  context.note_others(element, {"EntryList", "BaseContainer", "BinaryEncoding"}, "it is not used");
}

}  // namespace reident::satcs::xtce
