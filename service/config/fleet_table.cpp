#include "service/config/fleet_table.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include "service/config/config_document.hpp"

namespace reident {
namespace {

constexpr int most_gateways = 100;

/// What spacecraft have where they do not say otherwise; {} stands for the name.
struct FleetDefaults {
  std::optional<std::string> configuration;
  std::string partition = "operations/{}";
  std::string data = "/var/lib/reident/{}";
  std::optional<std::string> memory_max, cpu_quota;
};

std::string with_name(std::string text, const std::string& name) {
  for (std::size_t at = text.find("{}"); at != std::string::npos; at = text.find("{}", at))
    text.replace(at, 2, name), at += name.size();
  return text;
}

bool is_unit_name(const std::string& name) {
  const auto allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  };
  return !name.empty() && name.front() != '.' && std::all_of(name.begin(), name.end(), allowed);
}

std::optional<FleetNetwork> read_network(TableReader& fleet, ConfigDocument& document) {
  const toml::table* table = fleet.section("network");
  if (table == nullptr) return std::nullopt;
  TableReader reader(*table, "[fleet.network]", document);
  FleetNetwork network;
  reader.require("host", "\"10.0.0.1\"");
  network.host = reader.text("host").value_or("");
  network.gateways =
      static_cast<int>(reader.integer("gateways", 0, most_gateways).value_or(network.gateways));
  reader.refuse_unknown_keys();
  return network;
}

void read_defaults(const toml::table& table, ConfigDocument& document, Fleet& fleet,
                   FleetDefaults& defaults) {
  TableReader reader(table, "[fleet]", document);
  defaults.configuration = reader.text("configuration");
  if (const auto domain = reader.integer("domain", 0, 230))
    fleet.domain = static_cast<std::uint32_t>(*domain);
  defaults.partition = reader.text("partition").value_or(defaults.partition);
  defaults.data = reader.text("data").value_or(defaults.data);
  defaults.memory_max = reader.text("memory_max");
  defaults.cpu_quota = reader.text("cpu_quota");
  fleet.network = read_network(reader, document);
  reader.refuse_unknown_keys();
}

std::optional<FleetInstance> read_instance(const toml::table& table, ConfigDocument& document,
                                           const Fleet& fleet, const FleetDefaults& defaults,
                                           const std::filesystem::path& folder) {
  TableReader reader(table, "[[spacecraft]]", document);
  reader.require("name", "\"SAT-1\"");
  const auto name = reader.text("name");
  const auto configuration = reader.text("configuration");
  const auto partition = reader.text("partition"), data = reader.text("data");
  const auto memory_max = reader.text("memory_max"), cpu_quota = reader.text("cpu_quota");
  FleetInstance instance;
  instance.page = reader.text("page");
  const auto host = reader.text("host");
  if (host && !fleet.network)
    reader.mistake("host", "host needs a [fleet.network], which says that there is one");
  if (fleet.network) instance.host = host.value_or(fleet.network->host);
  reader.refuse_unknown_keys();
  if (!name) return std::nullopt;
  instance.name = *name;
  if (!is_unit_name(*name))
    reader.mistake("name", fmt::format("{} has to have letters, digits, - _ and . alone: it is "
                                       "part of a unit's name and of a file's",
                                       *name));
  const auto source = configuration ? configuration : defaults.configuration;
  if (!source)
    reader.mistake("configuration",
                   "configuration is missing, such as \"satellite.toml\": here, "
                   "or in [fleet] for all");
  instance.configuration = folder / source.value_or("");
  instance.partition = with_name(partition.value_or(defaults.partition), *name);
  instance.data = with_name(data.value_or(defaults.data), *name);
  if (!instance.data.is_absolute())
    reader.mistake("data",
                   fmt::format("data {} has to be an absolute path", instance.data.string()));
  instance.memory_max = memory_max ? memory_max : defaults.memory_max;
  instance.cpu_quota = cpu_quota ? cpu_quota : defaults.cpu_quota;
  return instance;
}

/// What two spacecraft may not share.
void refuse_shared(const Fleet& fleet, ConfigDocument& document) {
  std::set<std::string> names, partitions, folders;
  const auto refuse = [&](const FleetInstance& one, const std::string& what) {
    document.mistakes.push_back(
        {0, fmt::format("spacecraft {} has {} of another one", one.name, what)});
  };
  for (const FleetInstance& one : fleet.instances) {
    if (!names.insert(one.name).second) refuse(one, "the name");
    if (!partitions.insert(one.partition).second) refuse(one, "partition " + one.partition);
    if (!folders.insert(one.data.lexically_normal().string()).second)
      refuse(one, "folder " + one.data.string());
  }
}

}  // namespace

std::variant<Fleet, std::vector<ConfigMistake>> load_fleet(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return std::vector{ConfigMistake{0, "cannot be read; check the path and its permissions"}};
  ConfigDocument document = parse_document(std::string(std::istreambuf_iterator<char>(stream), {}));
  Fleet fleet;
  FleetDefaults defaults;
  TableReader reader(document.table, "the file:", document);
  if (const toml::table* table = reader.section("fleet"))
    read_defaults(*table, document, fleet, defaults);
  for (const toml::table* table : reader.sections("spacecraft"))
    if (auto one = read_instance(*table, document, fleet, defaults, file.parent_path()))
      fleet.instances.push_back(*std::move(one));
  reader.refuse_unknown_keys();
  if (fleet.instances.empty() && document.mistakes.empty())
    document.mistakes.push_back({0, "has no [[spacecraft]] with a name"});
  refuse_shared(fleet, document);
  if (document.mistakes.empty()) return fleet;
  std::ranges::stable_sort(document.mistakes, {}, &ConfigMistake::line);
  return std::move(document.mistakes);
}

}  // namespace reident
