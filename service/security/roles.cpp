#include "service/security/roles.hpp"

#include <algorithm>
#include <fnmatch.h>

#include "service/support/text.hpp"

namespace reident::security {
namespace {

std::string joined_names(bool (*chosen)(const Role&, Direction, std::string_view),
                         Direction direction, std::string_view topic) {
  std::vector<std::string> names;
  for (const Role& role : roles())
    if (chosen(role, direction, topic)) names.emplace_back(role.name);
  return joined(names);
}

}  // namespace

const std::vector<Role>& roles() {
  static const std::vector<Role> all = {
      {"service",
       "reidentd, and its standby",
       {"reident/ModelVersion", "reident/IdentificationReport", "reident/ServiceStatus",
        "reident/CommandReply", "reident/HistoryReply", "reident/Leadership", "reident/Replica"},
       {"satcs/*", "reident/ModelAcknowledgement", "reident/Command", "reident/HistoryRequest",
        "reident/ServiceStatus", "reident/Leadership", "reident/Replica"}},
      {"gateway", "a source of telemetry: SATCS, satcs-replay, satcs-reference", {"satcs/*"}, {}},
      {"simulator",
       "a program that runs models",
       {"reident/ModelAcknowledgement"},
       {"reident/ModelVersion", "satcs/*"}},
      {"operator",
       "a person at the command line",
       {"reident/Command", "reident/HistoryRequest"},
       {"reident/*"}},
      {"page",
       "reident-web",
       {"reident/Command"},
       {"reident/ServiceStatus", "reident/ModelVersion", "reident/CommandReply"}}};
  return all;
}

const Role* find_role(std::string_view name) {
  const auto found = std::find_if(roles().begin(), roles().end(),
                                  [name](const Role& role) { return role.name == name; });
  return found == roles().end() ? nullptr : &*found;
}

std::string role_names() {
  return joined_names([](const Role&, Direction, std::string_view) { return true; },
                      Direction::publish, "");
}

bool may(const Role& role, Direction direction, std::string_view topic) {
  const auto& patterns = direction == Direction::publish ? role.publishes : role.subscribes;
  const std::string name(topic);
  return std::any_of(patterns.begin(), patterns.end(), [&name](std::string_view pattern) {
    return fnmatch(std::string(pattern).c_str(), name.c_str(), FNM_NOESCAPE) == 0;
  });
}

std::string roles_that_may(Direction direction, std::string_view topic) {
  return joined_names(may, direction, topic);
}

bool may_order(std::string_view role) {
  const Role* found = find_role(role);
  return found != nullptr && may(*found, Direction::publish, "reident/Command");
}

}  // namespace reident::security
