#include "service/config/fleet_table.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <set>
#include <span>
#include <system_error>

#include <arpa/inet.h>
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
  std::optional<std::string> memory_max, cpu_quota, standby;
};

std::string with_name(std::string text, const std::string& name) {
  for (std::size_t at = text.find("{}"); at != std::string::npos; at = text.find("{}", at))
    text.replace(at, 2, name), at += name.size();
  return text;
}

/// What systemd takes for the end of a whole name: it would start another instance.
constexpr std::array<std::string_view, 11> kinds_of_unit{
    ".service", ".socket", ".device", ".mount", ".automount", ".swap",
    ".target",  ".path",   ".timer",  ".slice", ".scope"};

bool is_unit_name(const std::string& name) {
  const auto allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
  };
  const auto is_end = [&name](std::string_view kind) { return name.ends_with(kind); };
  return !name.empty() && name.front() != '.' && std::ranges::all_of(name, allowed) &&
         std::ranges::none_of(kinds_of_unit, is_end);
}

constexpr std::string_view no_limit = "infinity";

struct LimitUnit {
  std::string_view name;
  double size;
  double most;  // of what systemd takes, in units
};

constexpr double most_bytes = 1LL << 62;
constexpr std::array memory_units{
    LimitUnit{"", 1, most_bytes},
    LimitUnit{"B", 1, most_bytes},
    LimitUnit{"K", 1LL << 10, most_bytes},
    LimitUnit{"M", 1LL << 20, most_bytes},
    LimitUnit{"G", 1LL << 30, most_bytes},
    LimitUnit{"T", 1LL << 40, most_bytes},
    LimitUnit{"%", 1, 100},
};
constexpr std::array quota_units{LimitUnit{"%", 1, 100 * 1024}};

/// Reads a number with one of these units, or that there is no limit. What systemd does not take it
/// ignores, with a warning that nobody sees: no limit would hold.
std::optional<std::string> read_limit(TableReader& reader, std::string_view key,
                                      std::span<const LimitUnit> units, std::string_view example) {
  auto text = reader.text(key);
  if (!text || *text == no_limit) return text;
  double number = 0;
  const auto [end, error] =
      std::from_chars(text->data(), text->data() + text->size(), number, std::chars_format::fixed);
  const std::string_view name(end, text->data() + text->size());
  const auto unit = std::ranges::find(units, name, &LimitUnit::name);
  const std::string_view digits(text->data(), end);
  const std::size_t point = digits.find('.');
  const bool is_too_fine = point != std::string_view::npos && digits.size() - point > 3;
  if (error != std::errc() || unit == units.end() || number <= 0 || is_too_fine ||
      number * unit->size > unit->most || number * unit->size < 0.01)
    reader.mistake(key, fmt::format("{} \"{}\" is no limit of systemd; use one such as \"{}\", or "
                                    "\"{}\" for none",
                                    key, *text, example, no_limit));
  return text;
}

std::optional<std::string> read_memory_max(TableReader& reader) {
  return read_limit(reader, "memory_max", memory_units, "1G");
}

std::optional<std::string> read_cpu_quota(TableReader& reader) {
  return read_limit(reader, "cpu_quota", quota_units, "50%");
}

/// The one of the table where it has one; absent where there is none.
std::optional<std::string> limit_of(const std::optional<std::string>& own,
                                    const std::optional<std::string>& by_default) {
  const auto& limit = own ? own : by_default;
  return limit == no_limit ? std::nullopt : limit;
}

/// The middleware takes an interface by its address, not by a name.
std::optional<std::string> read_host(TableReader& reader, std::string_view key = "host") {
  auto host = reader.text(key);
  in_addr address{};
  if (host && inet_pton(AF_INET, host->c_str(), &address) != 1)
    reader.mistake(key, fmt::format("{} \"{}\" is no address of a machine; use one such as "
                                    "\"10.0.0.1\"",
                                    key, *host));
  return host;
}

/// systemd would take the rest of the path for another one, or replace what it holds.
bool is_plain_path(const std::string& path) {
  return path.find_first_of(" \t\n\r\"'\\%$") == std::string::npos;
}

/// Each folder has one spelling.
std::filesystem::path folder_of(const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(text).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

std::optional<std::string> read_page(TableReader& reader) {
  auto page = reader.text("page");
  if (!page) return page;
  const std::size_t colon = std::min(page->rfind(':'), page->size());
  int port = 0;
  const char* end = page->data() + page->size();
  const char* digits = page->data() + std::min(colon + 1, page->size());
  const auto read = std::from_chars(digits, end, port);
  if (colon == 0 || page->find_first_of(" \t\n\r/") != std::string::npos ||
      read.ec != std::errc{} || read.ptr != end || port < 1 || port > 65535)
    reader.mistake("page", fmt::format("page \"{}\" has to be the host and port of a page, such as "
                                       "\"127.0.0.1:8480\"",
                                       *page));
  return page;
}

std::optional<FleetNetwork> read_network(TableReader& fleet, ConfigDocument& document) {
  const toml::table* table = fleet.section("network");
  if (table == nullptr) return std::nullopt;
  TableReader reader(*table, "[fleet.network]", document);
  FleetNetwork network;
  reader.require("host", "\"10.0.0.1\"");
  network.host = read_host(reader).value_or("");
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
  defaults.memory_max = read_memory_max(reader);
  defaults.cpu_quota = read_cpu_quota(reader);
  defaults.standby = read_host(reader, "standby");
  fleet.network = read_network(reader, document);
  if (defaults.standby && !fleet.network)
    reader.mistake("standby", "standby needs a [fleet.network], by which the two find each other");
  reader.refuse_unknown_keys();
}

/// What two spacecraft may not share, of those that were read.
struct Taken {
  std::set<std::string> names, partitions, folders, pages;
};

void refuse_shared(const FleetInstance& one, TableReader& reader, Taken& taken) {
  const auto refuse = [&](std::string_view key, const std::string& what) {
    reader.mistake(key, fmt::format("spacecraft {} has {} of another one", one.name, what));
  };
  // The others follow from the name.
  if (!taken.names.insert(one.name).second) return refuse("name", "the name");
  if (!taken.partitions.insert(one.partition).second)
    refuse("partition", "partition " + one.partition);
  if (!taken.folders.insert(one.data.string()).second)
    refuse("data", "folder " + one.data.string());
  if (one.page && !taken.pages.insert(*one.page).second) refuse("page", "page " + *one.page);
}

void read_instance(const toml::table& table, ConfigDocument& document,
                   const FleetDefaults& defaults, const std::filesystem::path& folder, Taken& taken,
                   Fleet& fleet) {
  TableReader reader(table, "[[spacecraft]]", document);
  reader.require("name", "\"SAT-1\"");
  const auto name = reader.text("name");
  const auto configuration = reader.text("configuration");
  const auto partition = reader.text("partition"), data = reader.text("data");
  const auto memory_max = read_memory_max(reader), cpu_quota = read_cpu_quota(reader);
  FleetInstance instance;
  instance.page = read_page(reader);
  const auto host = read_host(reader), standby = read_host(reader, "standby");
  for (const char* key : {"host", "standby"})
    if (reader.has(key) && !fleet.network)
      reader.mistake(key,
                     fmt::format("{} needs a [fleet.network], which says that there is one", key));
  const std::string second = standby ? *standby : defaults.standby.value_or("");
  if (fleet.network) {
    instance.host = host.value_or(fleet.network->host);
    if (second == instance.host)
      reader.mistake(
          standby ? "standby" : "host",
          fmt::format("host {} is that of the standby too; name another machine", instance.host));
  }
  reader.refuse_unknown_keys();
  if (!name) return;
  instance.name = instance.spacecraft = *name;
  if (!is_unit_name(*name))
    reader.mistake("name",
                   fmt::format("{} has to have letters, digits, - _ and . alone, and no end "
                               "such as .service: it is part of a unit's name and of a "
                               "file's",
                               *name));
  const auto source = configuration ? configuration : defaults.configuration;
  if (!source)
    reader.mistake("configuration",
                   "configuration is missing, such as \"satellite.toml\": here, "
                   "or in [fleet] for all");
  instance.configuration = folder / source.value_or("");
  instance.partition = with_name(partition.value_or(defaults.partition), *name);
  instance.data = folder_of(with_name(data.value_or(defaults.data), *name));
  if (!instance.data.is_absolute())
    reader.mistake("data",
                   fmt::format("data {} has to be an absolute path", instance.data.string()));
  if (is_unit_name(*name) && !is_plain_path(instance.data.string()))
    reader.mistake("data",
                   fmt::format("data {} has to be a path without blanks, quotes, \\, % and $: "
                               "units hold it",
                               instance.data.string()));
  instance.memory_max = limit_of(memory_max, defaults.memory_max);
  instance.cpu_quota = limit_of(cpu_quota, defaults.cpu_quota);
  refuse_shared(instance, reader, taken);
  instance.strength = second.empty() ? 0 : 2;
  fleet.instances.push_back(instance);
  if (second.empty()) return;
  // Its folder is on a machine of its own.
  instance.name += "-standby";
  instance.strength = 1;
  instance.host = second;
  instance.page.reset();
  if (!taken.names.insert(instance.name).second)
    reader.mistake("name", fmt::format("{} is the name of a standby too", instance.name));
  fleet.instances.push_back(std::move(instance));
}

}  // namespace

std::variant<Fleet, std::vector<ConfigMistake>> load_fleet(const std::filesystem::path& file) {
  const auto read = read_file(file);
  if (const auto* unreadable = std::get_if<ConfigMistake>(&read)) return std::vector{*unreadable};
  ConfigDocument document = parse_document(std::get<std::string>(read));
  Fleet fleet;
  FleetDefaults defaults;
  Taken taken;
  TableReader reader(document.table, "the file:", document);
  if (const toml::table* table = reader.section("fleet"))
    read_defaults(*table, document, fleet, defaults);
  for (const toml::table* table : reader.sections("spacecraft"))
    read_instance(*table, document, defaults, file.parent_path(), taken, fleet);
  reader.refuse_unknown_keys();
  if (fleet.instances.empty() && document.mistakes.empty())
    document.mistakes.push_back({0, "has no [[spacecraft]] with a name"});
  if (document.mistakes.empty()) return fleet;
  std::ranges::stable_sort(document.mistakes, {}, &ConfigMistake::line);
  return std::move(document.mistakes);
}

}  // namespace reident
