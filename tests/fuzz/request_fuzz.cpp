// Any bytes that come on a connection are a request within the limits, or are refused with a status
// and a message, or wait for more, of which there is a bound. However they are cut into pieces on
// their way, they are the same request or none. (What is wrong at the end of a piece may be waited
// for until the deadline in the place of a refusal.)
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <variant>

#include "service/web/http_messages.hpp"

namespace {

using namespace reident::web;

void require(bool condition) {
  if (!condition) std::abort();
}

/// What became of the bytes of one connection: the first request, or a refusal, or neither yet.
struct Outcome {
  bool is_cut = false;  // the connection waits for more
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
  const std::string head = head_of(refusal, true, false);
  require(head.ends_with("\r\n\r\n") && head.find("\n\r\n") == head.size() - 3);
  return {.refused = refusal.status};
}

Outcome read(std::string_view coming, std::size_t piece, const HostNames& names) {
  RequestReader reader(names);
  std::string waiting;
  while (!reader.take(waiting)) {
    require(waiting.size() <= most_head_bytes);
    if (coming.empty()) return {.is_cut = true};
    waiting += coming.substr(0, piece);
    coming.remove_prefix(std::min(piece, coming.size()));
  }
  auto taken = reader.request("X-User");
  if (const auto* refusal = std::get_if<HttpResponse>(&taken)) return refused(*refusal);
  auto& request = std::get<HttpRequest>(taken);
  require(request.path.starts_with('/'));
  require(request.body.size() <= most_body_bytes && (request.is_post || request.body.empty()));
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
