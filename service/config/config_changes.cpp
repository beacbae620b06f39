#include "service/config/config_changes.hpp"

#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "service/config/config_document.hpp"
#include "service/support/text.hpp"

namespace reident {
namespace {

struct Change {
  std::string equipment;  // empty: all
  std::string key;
  toml::table value;  // under the key "value"
};

std::optional<Change> change_of(std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return std::nullopt;
  const std::string_view path = trimmed(text.substr(0, equals));
  const std::string value(trimmed(text.substr(equals + 1)));
  const std::size_t dot = path.rfind('.');
  Change change;
  if (dot != std::string_view::npos) change.equipment = path.substr(0, dot);
  change.key = dot == std::string_view::npos ? path : path.substr(dot + 1);
  if (change.key.empty() || value.empty()) return std::nullopt;
  if (auto parsed = toml::parse("value = " + value))
    change.value = std::move(parsed).table();
  else
    change.value.insert_or_assign("value", value);
  return change;
}

/// How many equipment tables got the value.
std::size_t apply(const Change& change, toml::table& document) {
  std::size_t count = 0;
  const auto tables = [](toml::table& table, std::string_view key, const auto& visit) {
    if (toml::array* array = table[key].as_array())
      for (toml::node& node : *array)
        if (toml::table* one = node.as_table()) visit(*one);
  };
  tables(document, "spacecraft", [&](toml::table& spacecraft) {
    tables(spacecraft, "equipment", [&](toml::table& equipment) {
      if (!change.equipment.empty() &&
          equipment["name"].value_or(std::string()) != change.equipment)
        return;
      equipment.insert_or_assign(change.key, *change.value.get("value"));
      ++count;
    });
  });
  return count;
}

toml::table& section(toml::table& document, std::string_view name) {
  if (document[name].as_table() == nullptr) document.insert_or_assign(name, toml::table());
  return *document[name].as_table();
}

void set_names(const ConfigChanges& changes, toml::table& document,
               std::vector<ConfigMistake>& mistakes) {
  if (!changes.database.empty())
    section(document, "archive").insert_or_assign("database", changes.database.string());
  if (!changes.service.empty())
    section(document, "service").insert_or_assign("name", changes.service);
  if (changes.strength > 0) {
    section(document, "service").insert_or_assign("standby", true);
    section(document, "service").insert_or_assign("strength", changes.strength);
  }
  if (!changes.partition.empty())
    section(document, "dds").insert_or_assign("partition", changes.partition);
  if (changes.domain)
    section(document, "dds").insert_or_assign("domain", static_cast<std::int64_t>(*changes.domain));
  if (changes.spacecraft.empty()) return;
  toml::array* all = document["spacecraft"].as_array();
  if (all == nullptr || all->size() != 1)
    mistakes.push_back({0, fmt::format("it has to have one [[spacecraft]], which becomes {}",
                                       changes.spacecraft)});
  else
    all->get(0)->as_table()->insert_or_assign("name", changes.spacecraft);
}

}  // namespace

std::variant<std::string, std::vector<ConfigMistake>> changed_config(
    const std::filesystem::path& file, const ConfigChanges& changes) {
  auto loaded = load_config(file);
  if (auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded))
    return std::move(*mistakes);
  std::ifstream stream(file, std::ios::binary);
  ConfigDocument document = parse_document(std::string(std::istreambuf_iterator<char>(stream), {}));
  std::vector<ConfigMistake> mistakes;
  set_names(changes, document.table, mistakes);
  if (const auto& security = std::get<Config>(loaded).security; !security.empty())
    section(document.table, "dds")
        .insert_or_assign("security", std::filesystem::absolute(security).string());
  for (const std::string& text : changes.equipment) {
    const auto change = change_of(text);
    if (!change)
      mistakes.push_back({0, fmt::format("the change {} is not KEY=VALUE or EQUIPMENT.KEY=VALUE, "
                                         "such as window=800min",
                                         text)});
    else if (change->key == "name")
      mistakes.push_back({0, fmt::format("the change {}: a name tells what is compared with what, "
                                         "and stays",
                                         text)});
    else if (apply(*change, document.table) == 0)
      mistakes.push_back(
          {0, fmt::format("the change {}: there is no equipment {}", text, change->equipment)});
  }
  if (!mistakes.empty()) return mistakes;
  std::ostringstream text;
  text << document.table << '\n';
  auto changed = parse_config(text.str(), file.parent_path());
  if (auto* of_changes = std::get_if<std::vector<ConfigMistake>>(&changed)) {
    for (ConfigMistake& mistake : *of_changes)  // in a text that nobody has seen
      mistake = {0, "with the changes: " + mistake.message};
    return std::move(*of_changes);
  }
  return text.str();
}

}  // namespace reident
