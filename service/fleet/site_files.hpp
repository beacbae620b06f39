// The files of a site's instances, as systemd, the middleware and Prometheus read them.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "service/config/fleet_table.hpp"

namespace reident::fleet {

/// By path from the root folder:
///
///   etc/reident/NAME.toml                                     the configuration of each
///   etc/systemd/system/reidentd@NAME.service.d/fleet.conf     limits, folder, middleware
///   etc/reident/targets.json                                  pages with metrics (file_sd_configs)
///
/// and where the table has a network, for CYCLONEDDS_URI of
///
///   etc/reident/cyclonedds/NAME.xml          the service
///   etc/reident/cyclonedds/NAME-clients.xml  simulators and consoles of this spacecraft
///   etc/reident/cyclonedds/clients.xml       those of several spacecraft
///   etc/reident/cyclonedds/gateway-N.xml     who sends telemetry; N from 1
///
/// Services are those of the machine `host`, of all machines by default. Throws
/// std::invalid_argument with every mistake of a configuration that they are made of, where the
/// ports of the network do not suffice, and where no service is of the machine.
std::map<std::filesystem::path, std::string> site_files(const Fleet& fleet,
                                                        const std::string& host = {});

/// What differs between the files and those below `root`, by the names of the instances.
struct SiteChange {
  std::vector<std::string> changed;  // their services have to be restarted where they run
  std::vector<std::string> gone;     // made by an earlier table: what is below root stays there
  /// The middleware's files of an earlier table, but for those of who is gone. Clients would go on
  /// asking where they say.
  std::vector<std::filesystem::path> stale;
};
SiteChange change_of(const std::map<std::filesystem::path, std::string>& files,
                     const std::filesystem::path& root);

/// HOST:PORT of the operators' pages, by spacecraft, that the targets in the folder of the
/// configurations name; none where these are not of a table.
std::map<std::string, std::string> pages_in(const std::filesystem::path& configurations);

/// Whether site_files() gave the text of this file.
bool is_of_table(const std::filesystem::path& file);

/// Writes the files below `root`, and removes those that are stale. Throws std::invalid_argument,
/// and writes nothing, where a file is there that is not of a table; std::runtime_error where one
/// cannot be written or removed.
void write_site_files(const std::map<std::filesystem::path, std::string>& files,
                      const SiteChange& change, const std::filesystem::path& root);

}  // namespace reident::fleet
