// Any bytes that come on a connection are a request within the limits, or are refused with a status
// and a message, or end the connection. However they are cut into pieces on their way, they are the
// same request or none. (A head that is wrong near the end of a piece may be waited for until the
// deadline in the place of a refusal.)
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <boost/asio/buffer.hpp>

#include "service/web/http_messages.hpp"

namespace {

namespace http = boost::beast::http;
using namespace reident::web;

void require(bool condition) {
  if (!condition) std::abort();
}

/// What became of the bytes of one connection: the first request, or a refusal, or neither yet.
struct Outcome {
  bool is_cut = false;  // the connection ends, or waits for more
  int refused = 0;      // status; 0: not
  HttpRequest request{};
  bool is_taken() const { return !is_cut && refused == 0; }
};

bool are_same(const Outcome& one, const Outcome& other) {
  const HttpRequest &a = one.request, &b = other.request;
  return one.is_taken() == other.is_taken() && a.path == b.path && a.query == b.query &&
         a.body == b.body && a.is_post == b.is_post && a.cookie == b.cookie && a.user == b.user;
}

Outcome refused(const HttpResponse& refusal) {
  require(refusal.status >= 400 && refusal.status < 500 && !refusal.body.empty());
  const auto message = message_of(refusal, true);
  require(message.body() == refusal.body && message.count(http::field::content_length) == 1);
  return {.refused = refusal.status};
}

/// Puts bytes in as the server does: all that came so far and was not taken, until head or body is
/// there. Absent where it is.
std::optional<Outcome> put(RequestParser& parser, std::string_view& coming, std::string& waiting,
                           std::size_t piece, bool with_body) {
  const auto is_there = [&] { return with_body ? parser.is_done() : parser.is_header_done(); };
  while (!is_there()) {
    boost::system::error_code error;
    const std::size_t taken = parser.put(boost::asio::buffer(waiting), error);
    waiting.erase(0, taken);
    if (error && error != http::error::need_more) {
      const auto refusal = refusal_of(error);
      return refusal ? refused(*refusal) : Outcome{.is_cut = true};
    }
    if (is_there() || (!error && taken > 0)) continue;
    if (waiting.size() >= most_head_bytes + most_body_bytes)  // the buffer is full
      return refused(*refusal_of(make_error_code(http::error::buffer_overflow)));
    if (coming.empty()) return Outcome{.is_cut = true};
    waiting += coming.substr(0, piece);
    coming.remove_prefix(std::min(piece, coming.size()));
  }
  return std::nullopt;
}

Outcome read(std::string_view bytes, std::size_t piece, const HostNames& names) {
  RequestParser parser;
  set_limits(parser);
  std::string waiting;
  if (auto outcome = put(parser, bytes, waiting, piece, false)) return *outcome;
  if (const auto refusal = refusal_of(parser, names)) return refused(*refusal);
  parser.eager(true);
  if (auto outcome = put(parser, bytes, waiting, piece, true)) return *outcome;
  const auto& message = parser.get();
  require(message.count(http::field::transfer_encoding) == 0);
  require(message.body().size() <= most_body_bytes);
  auto taken = read_request(message, "X-User");
  if (const auto* refusal = std::get_if<HttpResponse>(&taken)) return refused(*refusal);
  auto& request = std::get<HttpRequest>(taken);
  require(request.path.starts_with('/'));
  require(request.is_post || request.body.empty());
  require(!request.is_post ||
          std::to_string(request.body.size()) ==
              std::to_string(std::strtoull(
                  std::string(message[http::field::content_length]).c_str(), nullptr, 10)));
  request.parameter("begin");
  return {.request = std::move(request)};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t piece = 1 + data[0];
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  static const HostNames any({}), own({"localhost", "::1"});
  const Outcome whole = read(bytes, bytes.size() + 1, any);
  require(are_same(read(bytes, piece, any), whole));
  const Outcome named = read(bytes, piece, own);
  require(are_same(named, whole) || named.refused == 421);
  return 0;
}
