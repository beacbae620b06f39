#include "service/fleet/helm_values.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/fleet/site_files.hpp"

namespace reident::fleet {
namespace {

using nlohmann::ordered_json;

/// Kubernetes adds an ordinal and a hash to names of at most 63 characters.
constexpr std::size_t longest_resource = 40;

/// Names of objects have small letters, digits and - alone.
std::string resource_of(const FleetInstance& instance) {
  std::string resource = instance.name;
  for (char& c : resource)
    c = c == '_' || c == '.' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (resource.size() > longest_resource || resource.front() == '-' || resource.back() == '-')
    throw std::invalid_argument(fmt::format(
        "spacecraft {} cannot be a name of Kubernetes: it begins and ends with a letter "
        "or digit, and has at most {} characters",
        instance.name, longest_resource));
  return resource;
}

ordered_json limits_of(const FleetInstance& instance) {
  ordered_json limits = ordered_json::object();
  if (instance.memory_max) {
    const std::string& text = *instance.memory_max;
    if (text.ends_with('%'))
      throw std::invalid_argument(
          fmt::format("spacecraft {}: Kubernetes has no memory_max of {}; use one such as 1G",
                      instance.name, text));
    // Units of systemd are powers of 1024.
    limits["memory"] = std::isalpha(static_cast<unsigned char>(text.back())) == 0 ? text
                       : text.ends_with('B') ? text.substr(0, text.size() - 1)
                                             : text + "i";
  }
  if (instance.cpu_quota) {
    double percent = 0;
    std::from_chars(instance.cpu_quota->data(),
                    instance.cpu_quota->data() + instance.cpu_quota->size(), percent);
    limits["cpu"] = fmt::format("{}m", std::llround(10 * percent));
  }
  return limits;
}

}  // namespace

std::string helm_values(const Fleet& fleet) {
  const auto files = site_files(fleet);
  const std::filesystem::path folder = "etc/reident";
  ordered_json list = ordered_json::array();
  std::map<std::string, std::string> named;
  for (const FleetInstance& one : fleet.instances) {
    const std::string resource = resource_of(one);
    if (const auto [other, is_new] = named.emplace(resource, one.name); !is_new)
      throw std::invalid_argument(
          fmt::format("spacecraft {} and {} would both be reident-{} in Kubernetes: rename one",
                      other->second, one.name, resource));
    ordered_json values = {{"resource", resource},
                           {"name", one.name},
                           {"data", one.data.string()},
                           {"configuration", files.at(folder / (one.name + ".toml"))},
                           {"page", one.host.empty()}};
    if (auto limits = limits_of(one); !limits.empty()) values["limits"] = std::move(limits);
    if (!one.host.empty()) {
      const auto middleware = [&](const std::string& name) {
        return files.at(folder / "cyclonedds" / (name + ".xml"));
      };
      values["host"] = one.host;
      values["middleware"] = {{"service", middleware(one.name)},
                              {"clients", middleware(one.name + "-clients")}};
    }
    list.push_back(std::move(values));
  }
  return ordered_json({{"spacecraft", std::move(list)}}).dump(1) + "\n";
}

}  // namespace reident::fleet
