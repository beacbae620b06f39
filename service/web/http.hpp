// A request and its answer, as the page's server knows them: no type of the protocol's library
// shows here.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace reident::web {

/// A request whose head and body are complete and within the limits.
struct HttpRequest {
  bool is_post = false;  // else GET; HEAD is answered as GET, without the body
  std::string path;      // decoded, without the query
  std::vector<std::pair<std::string, std::string>> query;  // decoded, in their order
  std::string body;
  std::string content_type, origin, host, cookie;
  std::string token;       // header X-Reident-Token
  std::string etag;        // header If-None-Match
  std::string last_event;  // header Last-Event-ID
  bool accepts_gzip = false;
  std::string peer;        // address; "unix" of a Unix socket
  std::string user;        // by a client certificate or a trusted proxy; empty: not known
  bool is_secure = false;  // came over TLS

  /// The last value of that name; empty where there is none.
  std::string_view parameter(std::string_view name) const;
};

struct HttpResponse {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  bool is_gzip = false;  // the body is compressed
  std::vector<std::pair<std::string, std::string>> headers;
};

/// From here on the connection gets what changes, as server-sent events.
struct EventStream {
  std::uint64_t after = 0;  // the last revision that the client has; 0: none
};

using Answer = std::variant<HttpResponse, EventStream>;
/// Gives the answer: once, from any thread, also after the connection has ended.
using Respond = std::function<void(Answer)>;

/// Compresses a body that is worth it. The content stays the same to whoever asked for gzip.
void compress(HttpResponse& response);

/// Returns an answer `{"error": {"code", "message"}}`. `message` names what is wrong and the
/// remedy.
HttpResponse problem(int status, std::string_view code, std::string_view message);

}  // namespace reident::web
