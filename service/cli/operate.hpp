// An operator's command: through the running service, or on its database while none runs.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "service/cli/command.hpp"
#include "service/cli/stored.hpp"
#include "storage/registry/registry.hpp"

namespace reident::cli {

/// Where the service or its database is, and who orders.
struct OperatorOptions {
  DatabaseOptions database;
  std::optional<std::uint32_t> domain;
  std::optional<std::string> partition;
  std::optional<std::string> service;
  std::string actor;
  std::string reason;
  double timeout_s = 10;
  bool json = false;
};

/// What is ordered; `version` is 0 where the action names none.
struct OperatorOrder {
  std::string action;
  std::string spacecraft;  // empty: the only one that has the equipment
  std::string equipment;
  std::int64_t version = 0;
};

/// The name that was logged in with on this terminal, also under another user's rights, or without
/// a terminal that of this process's user; empty where the system has none.
std::string login_name();

/// Has the order carried out, prints the reply and returns the exit status. It is executed here if
/// the database is there and no other process holds its lock, else sent over DDS, the same request
/// again and again until the reply comes; so it is carried out once, whoever does it.
int operate(const OperatorOptions& options, const OperatorOrder& order);

}  // namespace reident::cli
