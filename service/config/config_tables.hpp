// What the tables of a configuration share: names, choices, units of time; and the table of an
// equipment. Private to this folder.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "service/config/config.hpp"
#include "service/config/config_document.hpp"

namespace reident {

inline constexpr Duration millisecond = 1'000'000;
inline constexpr Duration second = 1'000 * millisecond;
inline constexpr Duration minute = 60 * second;
inline constexpr Duration hour = 60 * minute;
inline constexpr Duration day = 24 * hour;

template <class Target, class Value>
void assign(Target& target, const std::optional<Value>& value) {
  if (value) target = static_cast<Target>(*value);
}

/// What is wrong with a name that becomes a DDS key, a part of SPACECRAFT/EQUIPMENT@VERSION and a
/// column of a terminal; empty when nothing is.
std::string name_mistake(std::string_view name);
/// Notes what is wrong with it, / and @ included.
void check_name(TableReader& reader, std::string_view key, const std::string& name);

/// The name of one of several, which those before it do not have; `kind` is what they are.
template <class Named>
void read_name(TableReader& reader, std::string_view kind, const std::vector<Named>& siblings,
               Named& target) {
  const std::optional<std::string> name = reader.text("name");
  if (!name) return;
  target.name = *name;
  check_name(reader, "name", *name);
  const auto same = [&](const Named& other) { return other.name == *name; };
  if (std::any_of(siblings.begin(), siblings.end(), same))
    reader.mistake("name", fmt::format("name {} is taken by {} {} above", *name,
                                       kind == "equipment" ? "an" : "a", kind));
  reader.set_title(fmt::format("{} {}:", kind, *name));
}

template <class Enum>
void read_choice(TableReader& reader, std::string_view key, Enum& target,
                 std::initializer_list<std::pair<std::string_view, Enum>> choices) {
  const std::optional<std::string> text = reader.text(key);
  if (!text) return;
  std::string allowed;
  for (const auto& [name, value] : choices) {
    if (*text == name) {
      target = value;
      return;
    }
    allowed += fmt::format("{}\"{}\"", allowed.empty() ? "" : ", ", name);
  }
  reader.mistake(key, fmt::format("{} must be one of {}, not \"{}\"", key, allowed, *text));
}

/// Reads an equipment and adds it to its siblings, where its name is new.
void read_equipment(const toml::table& table, ConfigDocument& document,
                    std::vector<EquipmentConfig>& siblings);

}  // namespace reident
