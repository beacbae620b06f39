#include "service/dds/codec.hpp"

namespace reident::dds {
namespace {

constexpr std::size_t max_terms = 100'000;
constexpr std::size_t max_bytes_of_rows = std::size_t{256} << 20;

}  // namespace

const reident_Leadership& Codec<Leadership>::Encoder::operator()(const Leadership& message) {
  wire_.pair = borrow(message.pair);
  wire_.term = message.term;
  wire_.service = borrow(message.service);
  wire_.position = message.position;
  wire_.successor = borrow(message.successor);
  return wire_;
}

Fault Codec<Leadership>::decode(const reident_Leadership& wire, const ReaderOptions& /*options*/,
                                Leadership& message) {
  TextReader texts;
  message.pair = texts.name(wire.pair, "pair");
  message.term = wire.term;
  message.service = texts.name(wire.service, "service");
  message.position = wire.position;
  message.successor = texts.text(wire.successor, "successor");
  if (texts.fault()) return texts.fault();
  if (message.term < 1 || message.position < 1) return "the term or the position is below 1";
  return std::nullopt;
}

const reident_Replica& Codec<Replica>::Encoder::operator()(const Replica& message) {
  wire_.sender = borrow(message.sender);
  wire_.pair = borrow(message.pair);
  wire_.receiver = borrow(message.receiver);
  wire_.kind = static_cast<std::uint8_t>(message.kind);
  wire_.after = message.part.after;
  wire_.last = message.part.last;
  terms_.clear();
  for (const storage::Term& term : message.terms)
    terms_.push_back({term.number, borrow(term.service), term.began, term.first});
  wire_.terms = borrow<decltype(wire_.terms)>(terms_);
  rows_ = message.part.rows;
  wire_.rows = borrow<decltype(wire_.rows)>(rows_);
  return wire_;
}

Fault Codec<Replica>::decode(const reident_Replica& wire, const ReaderOptions& /*options*/,
                             Replica& message) {
  TextReader texts;
  message.sender = texts.name(wire.sender, "sender");
  message.pair = texts.name(wire.pair, "pair");
  message.receiver = texts.text(wire.receiver, "receiver");
  message.part.after = wire.after;
  message.part.last = wire.last;
  if (texts.fault()) return texts.fault();
  if (wire.kind > static_cast<std::uint8_t>(Replica::Kind::kept))
    return "the kind " + std::to_string(wire.kind) + " is not known";
  message.kind = static_cast<Replica::Kind>(wire.kind);
  if (wire.after < 0 || wire.last < wire.after) return "the positions do not ascend from 0";
  if (wire.terms._length > max_terms) return "the terms are more than " + std::to_string(max_terms);
  if (wire.rows._length > max_bytes_of_rows) return "the rows are too large";
  for (std::uint32_t i = 0; i < wire.terms._length; ++i) {
    const reident_Term& term = wire.terms._buffer[i];
    message.terms.push_back(
        {term.number, texts.name(term.service, "a term's service"), term.began_ns, term.first});
  }
  if (wire.rows._length > 0)
    message.part.rows.assign(wire.rows._buffer, wire.rows._buffer + wire.rows._length);
  return texts.fault();
}

}  // namespace reident::dds
