#include "service/fleet/site_files.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/config/config_changes.hpp"
#include "service/support/output_file.hpp"

namespace reident::fleet {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view mark = "made by reident fleet init: change the table, and make it again";

std::string configuration_of(const FleetInstance& instance, std::uint32_t domain) {
  const auto text =
      changed_config(instance.configuration, {.database = instance.data / "reident.db",
                                              .spacecraft = instance.name,
                                              .service = instance.name,
                                              .partition = instance.partition,
                                              .domain = domain});
  if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&text)) {
    std::string all;
    for (const ConfigMistake& mistake : *mistakes)
      all +=
          fmt::format("{}{}{}: {}", all.empty() ? "" : "; ", instance.configuration.string(),
                      mistake.line == 0 ? "" : fmt::format(":{}", mistake.line), mistake.message);
    throw std::invalid_argument(all);
  }
  return fmt::format("# {}\n{}", mark, std::get<std::string>(text));
}

std::string drop_in_of(const FleetInstance& instance, bool has_network) {
  std::string text =
      fmt::format("# {}\n[Service]\nReadWritePaths=-{}\n", mark, instance.data.string());
  if (instance.memory_max) text += fmt::format("MemoryMax={}\n", *instance.memory_max);
  if (instance.cpu_quota) text += fmt::format("CPUQuota={}\n", *instance.cpu_quota);
  if (has_network)
    text += "Environment=CYCLONEDDS_URI=file:///etc/reident/cyclonedds.xml\nIPAddressAllow=any\n";
  return text;
}

std::string targets_of(const Fleet& fleet) {
  nlohmann::ordered_json targets = nlohmann::ordered_json::array();
  for (const FleetInstance& one : fleet.instances)
    if (one.page)
      targets.push_back(
          {{"targets", {*one.page}}, {"labels", {{"spacecraft", one.name}, {"made_by", mark}}}});
  return targets.dump(1) + "\n";
}

bool is_ours(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  return text.find(mark) != std::string::npos || text == "[]\n";
}

}  // namespace

std::string middleware_configuration(const FleetNetwork& network, std::uint32_t domain) {
  constexpr int first_port = 7400, standard_gain = 250, offset = 10, last_port = 65535;
  std::string discovery;
  std::string ports;
  if (network.peers.empty()) {
    // Others are told the port: no index, and so no bound of how many there are on a machine.
    discovery = "      <ParticipantIndex>none</ParticipantIndex>\n";
  } else {
    const int needed = offset + 2 * network.participants;
    const int gain = (needed + standard_gain - 1) / standard_gain * standard_gain;
    if (first_port + gain * (static_cast<int>(domain) + 1) > last_port)
      throw std::invalid_argument(fmt::format(
          "{} participants of a machine take {} ports of a domain, and domain {} has none left: "
          "use a lower domain, or fewer participants",
          network.participants, gain, domain));
    if (gain > standard_gain) ports = fmt::format("<DomainGain>{}</DomainGain>", gain);
    discovery = fmt::format(
        "      <ParticipantIndex>auto</ParticipantIndex>\n"
        "      <MaxAutoParticipantIndex>{}</MaxAutoParticipantIndex>\n",
        network.participants - 1);
    if (!ports.empty()) discovery += fmt::format("      <Ports>{}</Ports>\n", ports);
    discovery += "      <Peers>\n";
    for (const std::string& peer : network.peers)
      discovery += fmt::format("        <Peer address=\"{}\"/>\n", peer);
    discovery += "      </Peers>\n";
  }
  const bool is_address = network.interface.find_first_not_of("0123456789.") == std::string::npos ||
                          network.interface.find(':') != std::string::npos;
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<!-- {} -->\n"
      "<CycloneDDS xmlns=\"https://cdds.io/config\">\n"
      "  <Domain Id=\"any\">\n"
      "    <General>\n"
      "      <Interfaces><NetworkInterface {}=\"{}\" multicast=\"{}\"/></Interfaces>\n"
      "      <AllowMulticast>{}</AllowMulticast>\n"
      "      <MaxMessageSize>65500B</MaxMessageSize>\n"
      "      <FragmentSize>64000B</FragmentSize>\n"
      "    </General>\n"
      "    <Discovery>\n{}    </Discovery>\n"
      "  </Domain>\n"
      "</CycloneDDS>\n",
      mark, is_address ? "address" : "name", network.interface, network.peers.empty(),
      network.peers.empty() ? "spdp" : "false", discovery);
}

std::map<fs::path, std::string> site_files(const Fleet& fleet) {
  const fs::path configurations = "etc/reident", units = "etc/systemd/system";
  std::map<fs::path, std::string> files;
  for (const FleetInstance& one : fleet.instances) {
    files[configurations / (one.name + ".toml")] = configuration_of(one, fleet.domain);
    files[units / fmt::format("reidentd@{}.service.d", one.name) / "fleet.conf"] =
        drop_in_of(one, fleet.network.has_value());
  }
  if (fleet.network)
    files[configurations / "cyclonedds.xml"] =
        middleware_configuration(*fleet.network, fleet.domain);
  files[configurations / "targets.json"] = targets_of(fleet);
  return files;
}

void write_site_files(const std::map<fs::path, std::string>& files, const fs::path& root) {
  for (const auto& [path, text] : files)
    if (fs::exists(root / path) && !is_ours(root / path))
      throw std::invalid_argument(fmt::format(
          "{} is there and was not made by reident fleet init: nothing was written; move it away",
          (root / path).string()));
  for (const auto& [path, text] : files) {
    fs::create_directories((root / path).parent_path());
    OutputFile output(root / path);
    output.write(text);
    output.finish();
  }
}

}  // namespace reident::fleet
