#include "service/dds/codec.hpp"

namespace reident::dds {

const reident_Command& Codec<CommandRequest>::Encoder::operator()(const CommandRequest& request) {
  const storage::Command& command = request.command;
  wire_.requester = borrow(command.requester);
  wire_.request = command.request;
  wire_.action = borrow(command.action);
  wire_.spacecraft = borrow(command.spacecraft);
  wire_.equipment = borrow(command.equipment);
  wire_.version = command.version;
  wire_.actor = borrow(command.actor);
  wire_.reason = borrow(command.reason);
  wire_.service = borrow(request.service);
  wire_.certificate = borrow(request.certificate);
  wire_.signature = borrow(request.signature);
  return wire_;
}

// Whoever asks gets an answer: an operator's name that breaks the rules is refused in a reply.
Fault Codec<CommandRequest>::decode(const reident_Command& wire, const ReaderOptions& /*options*/,
                                    CommandRequest& request) {
  TextReader texts;
  storage::Command& command = request.command;
  command.requester = texts.name(wire.requester, "requester");
  command.request = wire.request;
  command.action = texts.text(wire.action, "action");
  command.spacecraft = texts.text(wire.spacecraft, "spacecraft");
  command.equipment = texts.text(wire.equipment, "equipment");
  command.version = wire.version;
  command.actor = texts.text(wire.actor, "actor");
  command.reason = texts.text(wire.reason, "reason");
  request.service = texts.text(wire.service, "service");
  request.certificate = texts.text(wire.certificate, "certificate");
  request.signature = texts.text(wire.signature, "signature");
  return texts.fault();
}

const reident_CommandReply& Codec<CommandReply>::Encoder::operator()(const CommandReply& reply) {
  wire_.requester = borrow(reply.requester);
  wire_.request = reply.request;
  wire_.ok = reply.outcome.ok;
  wire_.reason = borrow(reply.outcome.reply);
  return wire_;
}

Fault Codec<CommandReply>::decode(const reident_CommandReply& wire,
                                  const ReaderOptions& /*options*/, CommandReply& reply) {
  TextReader texts;
  reply.requester = texts.name(wire.requester, "requester");
  reply.request = wire.request;
  reply.outcome.ok = wire.ok;
  reply.outcome.reply = texts.text(wire.reason, "reason");
  return texts.fault();
}

}  // namespace reident::dds
