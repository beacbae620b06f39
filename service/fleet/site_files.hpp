// The files of a site's instances, as systemd, the middleware and Prometheus read them.
#pragma once

#include <filesystem>
#include <map>
#include <string>

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
/// Throws std::invalid_argument with every mistake of a configuration that they are made of, and
/// where the ports of the network do not suffice.
std::map<std::filesystem::path, std::string> site_files(const Fleet& fleet);

/// Writes the files below `root`. Throws std::invalid_argument, and writes nothing, where a file is
/// there that write_site_files() has not made; std::runtime_error where one cannot be written.
void write_site_files(const std::map<std::filesystem::path, std::string>& files,
                      const std::filesystem::path& root);

}  // namespace reident::fleet
