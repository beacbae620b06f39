// Between the protocol's library and HttpRequest and HttpResponse: what is refused, what is read,
// what every answer carries. Private to the server.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "service/web/http.hpp"

namespace reident::web {

inline constexpr std::size_t most_head_bytes = 8 << 10;
inline constexpr std::size_t most_body_bytes = 4 << 10;

using RequestParser = boost::beast::http::request_parser<boost::beast::http::string_body>;
using RequestMessage = boost::beast::http::request<boost::beast::http::string_body>;
using ResponseMessage = boost::beast::http::response<boost::beast::http::string_body>;

/// The names by which clients may ask; none given: any, for a proxy has checked it.
class HostNames {
 public:
  explicit HostNames(const std::vector<std::string>& names) : names_(names.begin(), names.end()) {}
  void add(const std::string& name) { names_.insert(name); }
  /// `host` as in the request: with a port or without, an IPv6 address in brackets.
  bool has(std::string_view host) const;

 private:
  std::set<std::string, std::less<>> names_;
};

void set_limits(RequestParser& parser);
/// The answer to a request that could not be read; absent where the connection just ended.
std::optional<HttpResponse> refusal_of(const boost::system::error_code& error);
/// The answer to a head that is refused; absent where it is not.
std::optional<HttpResponse> refusal_of(const RequestParser& parser, const HostNames& names);
/// The request, or the answer to one whose address cannot be read. `user_header`: a trusted
/// proxy's, or empty.
std::variant<HttpRequest, HttpResponse> read_request(const RequestMessage& message,
                                                     const std::string& user_header);
ResponseMessage message_of(const HttpResponse& response, bool is_secure);
/// The head of an answer that ends with its connection.
std::string event_stream_head(bool is_secure);

}  // namespace reident::web
