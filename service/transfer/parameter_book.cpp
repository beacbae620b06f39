#include "service/transfer/parameter_book.hpp"

#include <charconv>

#include <fmt/format.h>

#include "service/satcs/parameter_id.hpp"

namespace reident::transfer {
namespace {

std::optional<std::uint32_t> number_of(std::string_view name) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  return number;
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

std::variant<ParameterBook::Entry*, std::string> ParameterBook::find(std::string_view name,
                                                                     std::string_view unit,
                                                                     std::string_view description) {
  const auto found = by_name_.find(name);
  if (found == by_name_.end()) return add(name, unit, description);
  const std::string& known = found->second.descriptor.unit;
  if (unit.empty() || known.empty() || unit == known) return &found->second;
  return fmt::format("parameter '{}' is in {} here and in {} in the archive", name, unit, known);
}

std::variant<ParameterBook::Entry*, std::string> ParameterBook::add(std::string_view name,
                                                                    std::string_view unit,
                                                                    std::string_view description) {
  Entry entry;
  const auto number = number_of(name);
  entry.is_described = number.has_value();
  entry.descriptor.spacecraft = spacecraft_;
  entry.descriptor.id = number.value_or(satcs::parameter_id(name));
  entry.descriptor.name = name;
  entry.descriptor.unit = unit;
  entry.descriptor.description = description;
  const auto [owner, is_free] = name_of_.try_emplace(entry.descriptor.id, name);
  if (!is_free)
    return fmt::format("parameter '{}' would have the number {} of '{}'", name, owner->first,
                       owner->second);
  return &by_name_.emplace(std::string(name), std::move(entry)).first->second;
}

}  // namespace reident::transfer
