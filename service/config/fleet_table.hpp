// A site's spacecraft in one table, each of which has a service of its own (deploy/fleet.toml).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "service/config/config.hpp"

namespace reident {

/// One service, reidentd@NAME.
struct FleetInstance {
  std::string name;  // of the spacecraft; that of its standby ends with -standby
  std::string spacecraft;
  int strength = 0;                     // in a pair: 2, and 1 the standby; 0: it has none
  std::filesystem::path configuration;  // that it is made of
  std::string partition;
  std::filesystem::path data;                        // absolute; folder of its database
  std::optional<std::string> memory_max, cpu_quota;  // as systemd takes them
  std::string host;                 // address of its machine; empty without a network
  std::optional<std::string> page;  // HOST:PORT of its operators' page, which has its metrics
};

/// Programs of a site that find each other by fixed ports, and not by asking all: what a service
/// and its clients spend on discovery does not depend on how many others there are.
struct FleetNetwork {
  std::string host;  // address of the machine of the gateways, and of services that name none
  int gateways = 1;
};

struct Fleet {
  std::uint32_t domain = 0;
  /// Without it all traffic stays on the loopback interface, which has 120 ports of a domain.
  std::optional<FleetNetwork> network;
  std::vector<FleetInstance> instances;  // at least one; names are distinct
};

/// Returns the table in `file`, or every mistake in it, ordered by line. Relative paths begin in
/// the file's folder.
std::variant<Fleet, std::vector<ConfigMistake>> load_fleet(const std::filesystem::path& file);

}  // namespace reident
