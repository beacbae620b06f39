#include "service/cli/service_choice.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "service/cli/config_options.hpp"
#include "service/support/text.hpp"

namespace reident::cli {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto time_of_others = 300ms;  // for their last heartbeats to come

bool share_equipment(const ServiceStatus& a, const ServiceStatus& b) {
  const std::vector<std::string> ours = split_names(a.equipment);
  for (const std::string& one : split_names(b.equipment))
    if (std::find(ours.begin(), ours.end(), one) != ours.end()) return true;
  return false;
}

/// Whether another one has its name, or keeps one of its equipment.
bool has_double(const ServiceStatus& service, const std::vector<ServiceStatus>& all) {
  return std::any_of(all.begin(), all.end(), [&](const ServiceStatus& other) {
    return &other != &service &&
           (other.service == service.service || share_equipment(service, other));
  });
}

/// Leaves one of each pair: its leader, where it has one. Two of one name stay.
void keep_one_of_each_pair(std::vector<ServiceStatus>& services) {
  std::stable_partition(services.begin(), services.end(),
                        [](const ServiceStatus& one) { return one.role == "leads"; });
  std::map<std::string, std::string> kept;
  std::erase_if(services, [&](const ServiceStatus& one) {
    return !one.pair.empty() &&
           kept.try_emplace(one.pair, one.service).first->second != one.service;
  });
}

}  // namespace

std::variant<std::vector<ServiceStatus>, Refusal> heard_services(
    const dds::Endpoint& endpoint, std::chrono::milliseconds timeout) {
  dds::Participant participant(endpoint);
  dds::Reader<ServiceStatus> reader(participant);
  dds::WaitSet ready(participant);
  ready.attach(reader);
  std::map<std::pair<std::string, storage::Time>, ServiceStatus> heard;
  auto until = Clock::now() + timeout;
  for (auto now = Clock::now(); now < until; now = Clock::now()) {
    ready.wait(until - now);
    const bool was_empty = heard.empty();
    reader.take(64, [&heard](ServiceStatus&& status) {
      heard[{status.service, status.started}] = std::move(status);
    });
    if (was_empty && !heard.empty()) until = std::min(until, Clock::now() + time_of_others);
  }
  std::vector<ServiceStatus> services;
  for (auto& [key, status] : heard) services.push_back(std::move(status));
  if (services.empty() && participant.misses_security()) return missing_security(endpoint);
  return services;
}

void add_service_option(CLI::App& command, std::optional<std::string>& service) {
  command.add_option("--service", service, "the service of this name, where there are several");
}

std::variant<ServiceStatus, Refusal> chosen_service(const dds::Endpoint& endpoint,
                                                    const std::optional<std::string>& named,
                                                    const std::string& configured,
                                                    std::chrono::milliseconds timeout) {
  ServiceStatus nobody;
  nobody.service = named.value_or("");
  if (named) return nobody;
  auto heard = heard_services(endpoint, timeout);
  if (const auto* refusal = std::get_if<Refusal>(&heard)) return *refusal;
  auto services = std::get<std::vector<ServiceStatus>>(std::move(heard));
  keep_one_of_each_pair(services);
  if (services.empty()) return nobody;
  if (services.size() == 1) return services.front();
  std::vector<std::string> names;
  for (const ServiceStatus& service : services) {
    if (addressee(service) == configured && !has_double(service, services)) return service;
    names.push_back(service.service);
  }
  return Refusal{
      fmt::format("{} services are on domain {}, partition {}: {}; say which one with "
                  "--service NAME",
                  services.size(), endpoint.domain, endpoint.partition, joined(names))};
}

}  // namespace reident::cli
