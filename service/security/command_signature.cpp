#include "service/security/command_signature.hpp"

#include <fmt/format.h>

#include "service/security/openssl.hpp"
#include "service/security/roles.hpp"
#include "service/support/time_text.hpp"

namespace reident::security {
namespace {

void add(std::string& bytes, std::uint64_t number) {
  for (int i = 0; i < 8; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xff);
}

void add(std::string& bytes, const std::string& text) {
  add(bytes, std::uint64_t{text.size()});
  bytes += text;
}

std::string signed_bytes(const CommandRequest& request) {
  const storage::Command& command = request.command;
  std::string bytes;
  add(bytes, std::string("reident command 1"));
  add(bytes, command.requester);
  add(bytes, command.request);
  add(bytes, command.action);
  add(bytes, command.spacecraft);
  add(bytes, command.equipment);
  add(bytes, static_cast<std::uint64_t>(command.version));
  add(bytes, command.actor);
  add(bytes, command.reason);
  add(bytes, request.service);
  return bytes;
}

}  // namespace

void sign(CommandRequest& request, const Material& material) {
  if (material.role == "operator") request.command.actor = material.name;
  request.certificate = material.certificate;
  request.signature = sign_bytes(signed_bytes(request), read_key(material.key));
}

std::variant<Actor, std::string> actor_of(const CommandRequest& request, const Material& own,
                                          std::int64_t now) {
  if (request.signature.empty())
    return "the command is not signed, and this service takes signed ones alone: give --security "
           "the folder of an operator's certificate, or set REIDENT_SECURITY to it";
  const Certificate certificate = read_certificate(request.certificate);
  if (!certificate) return "the command brings no certificate in PEM; update the program";
  const Subject subject = subject_of(certificate);
  if (!is_signed_by(certificate, read_certificate(own.identity_authority)))
    return fmt::format(
        "the certificate of {} is of another authority; have one of this site made "
        "by 'reident security grant'",
        subject.name);
  const Validity validity = validity_of(certificate);
  if (now < validity.begin || validity.end <= now)
    return fmt::format("the certificate of {} is valid from {} to {}; renew it", subject.name,
                       time_text(validity.begin), time_text(validity.end));
  if (is_revoked(certificate, read_revocation_list(own.revoked)))
    return fmt::format("the certificate of {} is revoked", subject.name);
  if (!may_order(subject.unit))
    return fmt::format("{} {} may not order; roles that may are {}", subject.unit, subject.name,
                       roles_that_may(Direction::publish, "reident/Command"));
  if (!is_signature(request.signature, signed_bytes(request), certificate))
    return fmt::format("the command was changed after {} signed it; send it again", subject.name);
  if (subject.unit == "operator") return Actor{subject.name};
  return Actor{fmt::format("{} ({} {})", request.command.actor, subject.unit, subject.name)};
}

}  // namespace reident::security
