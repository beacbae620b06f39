// Who takes part on a secured domain, and what each may do there. A certificate carries one role.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace reident::security {

/// One row of the table of deploy/SECURITY.md. Topics are patterns of fnmatch.
struct Role {
  std::string_view name;
  std::string_view purpose;
  std::vector<std::string_view> publishes;
  std::vector<std::string_view> subscribes;
};

/// Every role, in the order of the page.
const std::vector<Role>& roles();
/// Null where there is none of the name.
const Role* find_role(std::string_view name);
/// "service, simulator, ...".
std::string role_names();

enum class Direction { publish, subscribe };

bool may(const Role& role, Direction direction, std::string_view topic);
/// The roles that may do so: "operator, page".
std::string roles_that_may(Direction direction, std::string_view topic);
/// Whether a command that is signed with a certificate of the role counts.
bool may_order(std::string_view role);

}  // namespace reident::security
