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
  std::string name;                     // of the spacecraft and of the service
  std::filesystem::path configuration;  // that it is made of
  std::string partition;
  std::filesystem::path data;                        // absolute; folder of its database
  std::optional<std::string> memory_max, cpu_quota;  // as systemd takes them
  std::optional<std::string> page;  // HOST:PORT of its operators' page, which has its metrics
};

/// How the middleware of the site finds others. Without it all stays on the loopback interface of
/// one machine, in 16 services of a domain.
struct FleetNetwork {
  std::string interface;           // its name or its address
  std::vector<std::string> peers;  // that are asked; empty: multicast
  int participants = 0;            // of a domain on a machine, where peers are asked
};

struct Fleet {
  std::uint32_t domain = 0;
  std::optional<FleetNetwork> network;
  std::vector<FleetInstance> instances;  // at least one; names are distinct
};

/// Returns the table in `file`, or every mistake in it, ordered by line. Relative paths begin in
/// the file's folder.
std::variant<Fleet, std::vector<ConfigMistake>> load_fleet(const std::filesystem::path& file);

}  // namespace reident
