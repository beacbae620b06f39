// Which of the services of a partition is asked, or gets an order.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "service/cli/command.hpp"
#include "service/config/config.hpp"
#include "service/dds/dds.hpp"

namespace reident::cli {

/// A service says once a second that it is there.
inline constexpr std::chrono::milliseconds heartbeat_wait{1500};

/// Whom commands are for: the service, or of a pair whoever leads it then.
inline const std::string& addressee(const ServiceStatus& service) {
  return service.pair.empty() ? service.service : service.pair;
}
using reident::addressee;

/// The last heartbeats of the services that are heard: none within `timeout`, or those that come in
/// a moment after the first one. Refused where the domain is secured and this program is not.
std::variant<std::vector<ServiceStatus>, Refusal> heard_services(const dds::Endpoint& endpoint,
                                                                 std::chrono::milliseconds timeout);

/// Adds --service.
void add_service_option(CLI::App& command, std::optional<std::string>& service);

/// The service that is meant, by its last heartbeat, of a pair its leader: `named` by an option, of
/// which the name alone is set; or the only one that is heard, or of several the one that the
/// configuration names, if it shares neither name nor equipment with another. Refused where that is
/// not clear, with the names. Without a name where none was heard within `timeout`: then whoever
/// hears the question may answer.
std::variant<ServiceStatus, Refusal> chosen_service(const dds::Endpoint& endpoint,
                                                    const std::optional<std::string>& named,
                                                    const std::string& configured,
                                                    std::chrono::milliseconds timeout);

}  // namespace reident::cli
