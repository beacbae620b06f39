#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "service/satcs/gateway/xtce_context.hpp"
#include "service/support/csv.hpp"

namespace reident::satcs::xtce {
namespace {

/// What describes for people, or says where else a thing is called how.
constexpr std::array<std::string_view, 7> for_people = {
    "Header",          "LongDescription", "AliasSet", "AncillaryDataSet", "DefaultRateInStream",
    "RateInStreamSet", "ReferenceTime"};

/// The path with "." and ".." gone through.
std::string plain(std::string_view path) {
  std::vector<std::string_view> parts;
  while (!path.empty()) {
    const auto end = std::min(path.find('/'), path.size());
    const std::string_view part = path.substr(0, end);
    path.remove_prefix(std::min(end + 1, path.size()));
    if (part == ".." && !parts.empty())
      parts.pop_back();
    else if (!part.empty() && part != "." && part != "..")
      parts.push_back(part);
  }
  std::string text;
  for (const std::string_view part : parts) text += "/" + std::string(part);
  return text;
}

}  // namespace

std::optional<Index> Names::find(std::string_view space, std::string_view reference) const {
  const auto look = [&](const std::string& path) -> std::optional<Index> {
    const auto found = index_.find(plain(path));
    return found == index_.end() ? std::nullopt : std::optional(found->second);
  };
  if (reference.empty()) return std::nullopt;
  if (reference.front() == '/') return look(std::string(reference));
  while (true) {
    if (const auto found = look(std::string(space) + "/" + std::string(reference))) return found;
    if (space.empty()) return std::nullopt;
    space = space.substr(0, space.rfind('/'));
  }
}

std::optional<std::int64_t> whole_number(std::string text) {
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.erase(0, 2);
  }
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

void Context::note(const XmlElement& element, std::string what) {
  database.notes.push_back({element.line(), element.path(), std::move(what)});
}

void Context::note_others(const XmlElement& element, std::initializer_list<std::string_view> known,
                          const std::string& consequence) {
  for (const XmlElement& child : element.children())
    if (std::find(known.begin(), known.end(), child.name()) == known.end() &&
        std::find(for_people.begin(), for_people.end(), child.name()) == for_people.end())
      note(child, consequence);
}

void Context::give_up(const XmlElement& element, ParameterType& type, const std::string& what) {
  note(element, what + "; its parameters are not published");
  type.is_usable = false;
}

double Context::number(const XmlElement& element, const char* attribute, double fallback) {
  const auto text = element.attribute(attribute);
  if (!text) return fallback;
  const auto value = csv::to_number(*text);
  if (!value) note(element, std::string(attribute) + " '" + *text + "' is no number");
  return value.value_or(fallback);
}

}  // namespace reident::satcs::xtce
