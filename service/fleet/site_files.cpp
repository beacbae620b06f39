#include "service/fleet/site_files.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/config/config_changes.hpp"
#include "service/support/output_file.hpp"

namespace reident::fleet {
namespace {

namespace fs = std::filesystem;

const fs::path configurations = "etc/reident", units = "etc/systemd/system";

constexpr const char* targets_name = "targets.json";

constexpr std::string_view mark = "made by reident fleet init: change the table, and make it again";

std::string configuration_of(const FleetInstance& instance, std::uint32_t domain) {
  const auto text =
      changed_config(instance.configuration, {.database = instance.data / "reident.db",
                                              .spacecraft = instance.spacecraft,
                                              .service = instance.spacecraft,
                                              .partition = instance.partition,
                                              .domain = domain,
                                              .strength = instance.strength});
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&text)) {
    std::string all = fmt::format("spacecraft {}: ", instance.name);
    for (const ConfigMistake& mistake : *mistakes)
      all += fmt::format(
          "{}{}{}: {}", &mistake == &mistakes->front() ? "" : "; ", instance.configuration.string(),
          mistake.line == 0 ? "" : fmt::format(":{}", mistake.line), mistake.message);
    throw std::invalid_argument(all);
  }
  return fmt::format("# {}\n{}", mark, std::get<std::string>(text));
}

/// Ports of the DDSI standard, and the files that name them. Services and gateways have the ports
/// of an index of their own on their machine. Clients have any, and ask only whom they need.
class Network {
 public:
  explicit Network(const Fleet& fleet) : fleet_(fleet) {
    for (const FleetInstance& one : fleet.instances) indices_[one.name] = next_[one.host]++;
    for (int i = 0; i < fleet.network->gateways; ++i)
      gateways_.push_back(next_[fleet.network->host]++);
    for (const auto& [host, count] : next_)
      gain_ = std::max(
          gain_, (first_offset + 2 * count + standard_gain - 1) / standard_gain * standard_gain);
    if (first_port + gain_ * (static_cast<int>(fleet.domain) + 1) > last_port)
      throw std::invalid_argument(fmt::format(
          "so many services of a machine take {} ports of a domain, and domain {} has none left: "
          "use a lower domain",
          gain_, fleet.domain));
  }

  std::map<fs::path, std::string> files() const {
    std::map<fs::path, std::string> files;
    const auto add = [&files](const std::string& name, std::string text) {
      if (!files.emplace(name, std::move(text)).second)
        throw std::invalid_argument(fmt::format(
            "cyclonedds/{} would be the file of two: rename the spacecraft that has its "
            "name",
            name));
    };
    std::vector<std::string> gateways, all;
    std::map<std::string, std::vector<std::string>> services;  // of each spacecraft: one, or a pair
    for (const int index : gateways_) gateways.push_back(address(fleet_.network->host, index));
    all = gateways;
    for (const FleetInstance& one : fleet_.instances) {
      all.push_back(address(one.host, indices_.at(one.name)));
      services[one.spacecraft].push_back(all.back());
    }
    for (const FleetInstance& one : fleet_.instances) {
      const int index = indices_.at(one.name);
      const std::vector<std::string>& of_spacecraft = services.at(one.spacecraft);
      std::vector<std::string> own = gateways;
      own.insert(own.end(), of_spacecraft.begin(), of_spacecraft.end());
      // Without any peer the middleware would ask the first ports of its machine: other services.
      add(one.name + ".xml", text(one.host, index, of_spacecraft));
      add(one.name + "-clients.xml", text(client_host(), std::nullopt, own));
    }
    add("clients.xml", text(client_host(), std::nullopt, all));
    for (std::size_t i = 0; i < gateways_.size(); ++i)
      add(fmt::format("gateway-{}.xml", i + 1),
          text(fleet_.network->host, gateways_[i],
               {all.begin() + std::ssize(gateways_), all.end()}));
    return files;
  }

 private:
  static constexpr int first_port = 7400, standard_gain = 250, first_offset = 10;
  static constexpr int last_port = 65535;

  std::string address(const std::string& host, int index) const {
    return fmt::format(
        "{}:{}", host,
        first_port + gain_ * static_cast<int>(fleet_.domain) + first_offset + 2 * index);
  }
  /// Clients of services on the loopback interface are there too; others have one of their own.
  std::string client_host() const {
    return fleet_.network->host.starts_with("127.") ? fleet_.network->host : "";
  }

  std::string text(const std::string& host, std::optional<int> index,
                   const std::vector<std::string>& peers) const {
    std::string interfaces, asked;
    if (!host.empty())
      interfaces = fmt::format(
          "<Interfaces><NetworkInterface address=\"{}\" multicast=\"false\"/></Interfaces>", host);
    for (const std::string& peer : peers) asked += fmt::format("<Peer address=\"{}\"/>\n", peer);
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- {} -->\n"
        "<CycloneDDS xmlns=\"https://cdds.io/config\">\n<Domain Id=\"any\">\n"
        "<General>{}<AllowMulticast>false</AllowMulticast>"
        "<MaxMessageSize>65500B</MaxMessageSize><FragmentSize>64000B</FragmentSize></General>\n"
        "<Discovery><ParticipantIndex>{}</ParticipantIndex><SPDPInterval>5s</SPDPInterval>"
        "<Ports><DomainGain>{}</DomainGain></Ports>\n<Peers>\n{}</Peers></Discovery>\n"
        "</Domain>\n</CycloneDDS>\n",
        mark, interfaces, index ? std::to_string(*index) : "none", gain_, asked);
  }

  const Fleet& fleet_;
  std::map<std::string, int> next_;  // index of each host
  std::map<std::string, int> indices_;
  std::vector<int> gateways_;
  int gain_ = standard_gain;
};

std::string drop_in_of(const FleetInstance& instance) {
  std::string text = fmt::format(
      "# {0}\n[Service]\nReadWritePaths=-{1}\n"
      "ExecStartPre=+/usr/bin/install -d -o reident -g reident -m 0750 {1}\n",
      mark, instance.data.string());
  if (instance.memory_max) text += fmt::format("MemoryMax={}\n", *instance.memory_max);
  if (instance.cpu_quota) text += fmt::format("CPUQuota={}\n", *instance.cpu_quota);
  if (instance.host.empty()) return text;
  text += fmt::format("Environment=CYCLONEDDS_URI=file:///etc/reident/cyclonedds/{}.xml\n",
                      instance.name);
  if (!instance.host.starts_with("127.")) text += "IPAddressAllow=any\n";
  return text;
}

std::string targets_of(const Fleet& fleet) {
  nlohmann::ordered_json targets = nlohmann::ordered_json::array();
  for (const FleetInstance& one : fleet.instances)
    if (one.page)
      targets.push_back({{"targets", {*one.page}},
                         {"labels", {{"spacecraft", one.spacecraft}, {"made_by", mark}}}});
  return targets.dump(1) + "\n";
}

fs::path configuration_path(const std::string& name) {
  return configurations / (name + ".toml");
}
fs::path drop_in_path(const std::string& name) {
  return units / fmt::format("reidentd@{}.service.d", name) / "fleet.conf";
}
fs::path middleware_path(const std::string& name) {
  return configurations / "cyclonedds" / (name + ".xml");
}
fs::path clients_path(const std::string& name) {
  return configurations / "cyclonedds" / (name + "-clients.xml");
}

/// Empty where there is none.
std::string text_of(const fs::path& file) {
  std::error_code none;
  if (!fs::is_regular_file(file, none)) return {};
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

std::map<fs::path, std::string> site_files(const Fleet& fleet, const std::string& host) {
  std::map<fs::path, std::string> files;
  if (fleet.network)
    for (auto& [name, text] : Network(fleet).files())
      files[configurations / "cyclonedds" / name] = text;
  bool has_service = false;
  for (const FleetInstance& one : fleet.instances) {
    if (!host.empty() && one.host != host) {
      files.erase(middleware_path(one.name));
      continue;
    }
    has_service = true;
    files[configuration_path(one.name)] = configuration_of(one, fleet.domain);
    files[drop_in_path(one.name)] = drop_in_of(one);
  }
  if (!has_service)
    throw std::invalid_argument(
        fmt::format("no spacecraft of the table has the host {}: use one that [fleet.network] or a "
                    "[[spacecraft]] names",
                    host));
  files[configurations / targets_name] = targets_of(fleet);
  return files;
}

SiteChange change_of(const std::map<fs::path, std::string>& files, const fs::path& root) {
  SiteChange change;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(root / configurations, none)) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".toml" || !is_of_table(entry.path())) continue;
    if (!files.contains(configuration_path(name))) {
      change.gone.push_back(name);
      continue;
    }
    for (const fs::path& path :
         {configuration_path(name), drop_in_path(name), middleware_path(name)}) {
      const auto now = files.find(path);
      if ((now == files.end() ? std::string() : now->second) == text_of(root / path)) continue;
      change.changed.push_back(name);
      break;
    }
  }
  for (const fs::directory_entry& entry :
       fs::directory_iterator(root / configurations / "cyclonedds", none)) {
    const fs::path path = configurations / "cyclonedds" / entry.path().filename();
    const auto is_its = [&path](const std::string& name) {
      return path == middleware_path(name) || path == clients_path(name);
    };
    if (!files.contains(path) && is_of_table(entry.path()) &&
        std::ranges::none_of(change.gone, is_its))
      change.stale.push_back(path);
  }
  std::ranges::sort(change.changed);
  std::ranges::sort(change.gone);
  std::ranges::sort(change.stale);
  return change;
}

std::map<std::string, std::string> pages_in(const fs::path& folder) {
  std::map<std::string, std::string> pages;
  const fs::path file = folder / targets_name;
  if (!is_of_table(file)) return pages;
  const auto targets = nlohmann::json::parse(text_of(file), nullptr, false);
  if (!targets.is_array()) return pages;
  for (const auto& one : targets) {
    const auto spacecraft = nlohmann::json::json_pointer("/labels/spacecraft");
    const auto address = nlohmann::json::json_pointer("/targets/0");
    if (one.contains(spacecraft) && one.contains(address) && one[spacecraft].is_string() &&
        one[address].is_string())
      pages[one[spacecraft]] = one[address];
  }
  return pages;
}

bool is_of_table(const fs::path& file) {
  const std::string text = text_of(file);
  return text.find(mark) != std::string::npos || text == "[]\n";
}

void write_site_files(const std::map<fs::path, std::string>& files, const SiteChange& change,
                      const fs::path& root) {
  for (const auto& [path, text] : files)
    if (fs::exists(root / path) && !is_of_table(root / path))
      throw std::invalid_argument(fmt::format(
          "{} is there and was not made by reident fleet init: nothing was written; move it away",
          (root / path).string()));
  for (const auto& [path, text] : files) {
    fs::create_directories((root / path).parent_path());
    OutputFile output(root / path);
    output.write(text);
    output.finish();
  }
  for (const fs::path& path : change.stale) fs::remove(root / path);
}

}  // namespace reident::fleet
