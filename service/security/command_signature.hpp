// Who orders: a command carries the certificate of its sender and a signature made with its key.
// idl/README.md, "Signed commands", has the bytes that are signed.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "service/model/messages.hpp"
#include "service/security/material.hpp"

namespace reident::security {

/// Adds certificate and signature. Of an operator's certificate, the actor becomes its name.
void sign(CommandRequest& request, const Material& material);

/// The name that a decision of this command carries: that of an operator's certificate, or with a
/// page's the user whom the page names, and the page: "ana (page web-1)".
struct Actor {
  std::string name;
};

/// Checks the signature against the authority and the revocations of the receiver's own material.
/// Returns why the command does not count where it does not: unsigned, changed, of a certificate
/// that is foreign, has ended, is revoked or is of a role that may not order.
std::variant<Actor, std::string> actor_of(const CommandRequest& request, const Material& own,
                                          std::int64_t now);

}  // namespace reident::security
