// Who may do what on the page: a file of accounts.
//
//   [[account]]
//   name = "Ana"               # stands in each decision
//   role = "approver"          # viewer, operator (hold, release, identify now) or approver
//   spacecraft = ["CBERS-4"]   # every one, where it is left out
//   password = "scrypt:..."    # of `reident-web --hash-password`; without: known by a certificate
//   or
//                              # by a proxy alone
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/config/config.hpp"

namespace reident::web {

/// Each may what those before it may.
enum class Role { viewer, controller, approver };
/// As the file has it; a controller is called "operator" there.
std::string_view name(Role role);

struct Account {
  std::string name;
  Role role = Role::viewer;
  std::vector<std::string> spacecraft;  // empty: every one
  std::string password;                 // hashed; empty: none

  bool may(Role asked, std::string_view of_spacecraft) const;
};

/// By name.
using Accounts = std::map<std::string, Account, std::less<>>;

/// Returns the accounts, or every mistake in the file, ordered by line.
std::variant<Accounts, std::vector<ConfigMistake>> load_accounts(const std::filesystem::path& path);

/// "scrypt:N:r:p:SALT:HASH", hexadecimal, with a new salt. Throws std::runtime_error where OpenSSL
/// does not provide it.
std::string hash_password(std::string_view password);
/// Takes a tenth of a second and 32 MiB, so that passwords cannot be tried fast.
bool matches(std::string_view password, std::string_view hashed);
/// Bytes that nobody can guess, hexadecimal.
std::string random_text(std::size_t bytes);

}  // namespace reident::web
