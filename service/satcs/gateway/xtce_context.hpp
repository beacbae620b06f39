// What the parts of the XTCE reader share: names, notes and the database that grows. Private to the
// reader (xtce_reader.hpp).
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "service/satcs/gateway/xml_document.hpp"
#include "service/satcs/gateway/xtce.hpp"

namespace reident::satcs::xtce {

/// Things of one kind by their paths, such as "/SAT/EPS/V_BUS".
class Names {
 public:
  /// False where the path is taken.
  bool add(const std::string& path, Index index) { return index_.emplace(path, index).second; }
  /// By a reference as it stands in the system `space`: absolute, or relative to the system or to
  /// one that it is in.
  std::optional<Index> find(std::string_view space, std::string_view reference) const;

 private:
  std::map<std::string, Index, std::less<>> index_;
};

/// The decimal number, or the hexadecimal one behind 0x; absent where the text is neither.
std::optional<std::int64_t> whole_number(std::string text);

struct Context {
  Database database;
  Names types, parameters, containers;

  void note(const XmlElement& element, std::string what);
  /// Notes each child of `element` but those of these names, and those that describe for people.
  void note_others(const XmlElement& element, std::initializer_list<std::string_view> known,
                   const std::string& consequence);
  /// Notes what is wrong with `type`, and makes it unusable.
  void give_up(const XmlElement& element, ParameterType& type, const std::string& what);
  /// The attribute as a number; a note, and `fallback`, where it is none. Absent: `fallback`.
  double number(const XmlElement& element, const char* attribute, double fallback);
};

/// Reads a type's encoding, calibrators, states, unit and limits into `type`, whose kind and
/// members are known. Names of parameters are known.
void read_type(Context& context, const XmlElement& element, const std::string& space,
               ParameterType& type);
/// Reads an encoding, with its calibrators, into `type`.
void read_encoding(Context& context, const XmlElement& element, const std::string& space,
                   ParameterType& type);
/// Reads a size: FixedValue, or DynamicValue of a parameter. Absent, with a note, for others.
std::optional<FieldSize> read_size(Context& context, const XmlElement& element,
                                   const std::string& space);

/// Reads the entries, base and criteria of a container. Names of containers are known.
void read_container(Context& context, const XmlElement& element, const std::string& space,
                    Container& container);
/// Reads what is in a RestrictionCriteria, IncludeCondition or ContextMatch. Absent, with a note,
/// where not all of it is known.
std::optional<Condition> read_condition(Context& context, const XmlElement& element,
                                        const std::string& space);

}  // namespace reident::satcs::xtce
