#include "service/dds/codec.hpp"

namespace reident::dds {
namespace {

// Far above what a page of the service holds.
constexpr std::size_t max_rows = 100'000;
constexpr std::size_t max_row_bytes = std::size_t{64} << 20;

}  // namespace

const reident_HistoryRequest& Codec<HistoryRequest>::Encoder::operator()(
    const HistoryRequest& request) {
  const HistoryQuery& query = request.query;
  wire_.slot = request.slot;
  wire_.requester = borrow(request.requester);
  wire_.request = request.request;
  wire_.service = borrow(request.service);
  wire_.subject = borrow(query.subject);
  wire_.spacecraft = borrow(query.spacecraft);
  wire_.equipment = borrow(query.equipment);
  wire_.begin_ns = query.range.begin;
  wire_.end_ns = query.range.end;
  wire_.version = query.version;
  wire_.page_size = query.page_size;
  wire_.cursor = borrow(query.cursor);
  wire_.newest_first = query.newest_first;
  wire_.origin = static_cast<std::uint8_t>(query.origin);
  wire_.parameter = query.parameter;
  wire_.step_ns = query.step;
  wire_.until_ns = query.until;
  return wire_;
}

// Whoever asks gets an answer: what is wrong with a question is said in the reply.
Fault Codec<HistoryRequest>::decode(const reident_HistoryRequest& wire,
                                    const ReaderOptions& /*options*/, HistoryRequest& request) {
  TextReader texts;
  HistoryQuery& query = request.query;
  request.slot = wire.slot;
  request.request = wire.request;
  request.requester = texts.name(wire.requester, "requester");
  request.service = texts.text(wire.service, "service");
  query.subject = texts.text(wire.subject, "subject");
  query.spacecraft = texts.text(wire.spacecraft, "spacecraft");
  query.equipment = texts.text(wire.equipment, "equipment");
  query.range = {wire.begin_ns, wire.end_ns};
  query.version = wire.version;
  query.page_size = wire.page_size;
  query.cursor = texts.text(wire.cursor, "cursor");
  query.newest_first = wire.newest_first;
  query.parameter = wire.parameter;
  query.step = wire.step_ns;
  query.until = wire.until_ns;
  if (texts.fault()) return texts.fault();
  if (wire.origin > static_cast<std::uint8_t>(storage::Origin::simulated))
    return "origin is neither 0 (real) nor 1 (simulated)";
  query.origin = static_cast<storage::Origin>(wire.origin);
  return std::nullopt;
}

const reident_HistoryReply& Codec<HistoryReply>::Encoder::operator()(const HistoryReply& reply) {
  wire_.slot = reply.slot;
  wire_.requester = borrow(reply.requester);
  wire_.request = reply.request;
  wire_.service = borrow(reply.service);
  wire_.ok = reply.ok;
  wire_.reason = borrow(reply.reason);
  rows_.clear();
  for (const std::string& row : reply.page.rows) rows_.push_back(borrow(row));
  wire_.rows = borrow<decltype(wire_.rows)>(rows_);
  wire_.next_cursor = borrow(reply.page.next_cursor);
  return wire_;
}

Fault Codec<HistoryReply>::decode(const reident_HistoryReply& wire,
                                  const ReaderOptions& /*options*/, HistoryReply& reply) {
  TextReader texts;
  reply.slot = wire.slot;
  reply.request = wire.request;
  reply.requester = texts.name(wire.requester, "requester");
  reply.service = texts.text(wire.service, "service");
  reply.ok = wire.ok;
  reply.reason = texts.text(wire.reason, "reason");
  reply.page.next_cursor = texts.text(wire.next_cursor, "next_cursor");
  if (wire.rows._length > max_rows) return "rows are more than " + std::to_string(max_rows);
  for (std::uint32_t i = 0; i < wire.rows._length && !texts.fault(); ++i)
    reply.page.rows.push_back(texts.text(wire.rows._buffer[i], "a row", max_row_bytes));
  return texts.fault();
}

}  // namespace reident::dds
