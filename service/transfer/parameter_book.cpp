#include "service/transfer/parameter_book.hpp"

#include <charconv>

#include <fmt/format.h>

#include "service/satcs/parameter_id.hpp"
#include "service/telemetry_file/cell_format.hpp"

namespace reident::transfer {
namespace {

std::optional<std::uint32_t> number_of(std::string_view name) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  return number;
}

/// The states that a description begins with, as satcs::choose_columns() writes them.
telemetry_file::StateMap states_in(std::string_view description) {
  constexpr std::string_view word = "states ";
  if (!description.starts_with(word)) return {};
  description.remove_prefix(word.size());
  return telemetry_file::parse_states(description.substr(0, description.find(';')))
      .value_or(telemetry_file::StateMap{});
}

}  // namespace

ParameterBook::ParameterBook(const storage::Archive& archive, std::string spacecraft)
    : spacecraft_(std::move(spacecraft)) {
  for (auto& descriptor : archive.parameters(spacecraft_)) {
    name_of_.emplace(descriptor.id, descriptor.name);
    // Among several with one name the lowest number counts, which comes first.
    by_name_.try_emplace(descriptor.name, Entry{descriptor, true});
  }
}

std::variant<ParameterBook::Entry*, std::string> ParameterBook::find(
    const storage::ParameterDescriptor& wanted) {
  const auto found = by_name_.find(wanted.name);
  if (found == by_name_.end()) return add(wanted);
  const storage::ParameterDescriptor& known = found->second.descriptor;
  if (!wanted.unit.empty() && !known.unit.empty() && wanted.unit != known.unit)
    return fmt::format("parameter '{}' is in {} here and in {} in the archive", wanted.name,
                       wanted.unit, known.unit);
  for (const auto& [state, value] : states_in(known.description))
    for (const auto& [other, number] : states_in(wanted.description))
      if (state == other && value != number)
        return fmt::format("state '{}' of parameter '{}' is {} here and {} in the archive", state,
                           wanted.name, number, value);
  return &found->second;
}

std::variant<ParameterBook::Entry*, std::string> ParameterBook::add(
    const storage::ParameterDescriptor& wanted) {
  Entry entry;
  const auto number = number_of(wanted.name);
  entry.is_described = number.has_value();
  entry.descriptor = wanted;
  entry.descriptor.spacecraft = spacecraft_;
  entry.descriptor.id = number.value_or(satcs::parameter_id(wanted.name));
  const auto [owner, is_free] = name_of_.try_emplace(entry.descriptor.id, wanted.name);
  if (!is_free)
    return fmt::format("parameter '{}' would have the number {} of '{}'", wanted.name, owner->first,
                       owner->second);
  return &by_name_.emplace(wanted.name, std::move(entry)).first->second;
}

}  // namespace reident::transfer
