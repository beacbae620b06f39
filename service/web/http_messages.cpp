#include "service/web/http_messages.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <boost/beast/http/error.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>

namespace reident::web {
namespace {

namespace http = boost::beast::http;

using NamedValue = std::pair<std::string_view, std::string_view>;

constexpr std::array headers_of_all = {
    NamedValue{"Content-Security-Policy",
               "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
               "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    NamedValue{"X-Content-Type-Options", "nosniff"},
    NamedValue{"Referrer-Policy", "no-referrer"},
    NamedValue{"Cross-Origin-Opener-Policy", "same-origin"},
    NamedValue{"Cross-Origin-Resource-Policy", "same-origin"},
    NamedValue{"Vary", "Accept-Encoding"}};
constexpr NamedValue header_of_tls{"Strict-Transport-Security", "max-age=31536000"};

std::string text_of(boost::core::string_view text) {
  return {text.data(), text.size()};
}

std::string header(const RequestMessage& message, std::string_view name) {
  return text_of(message[boost::core::string_view(name.data(), name.size())]);
}

bool accepts_gzip(const RequestMessage& message) {
  for (const auto& coding : http::ext_list(message[http::field::accept_encoding])) {
    if (!boost::beast::iequals(coding.first, "gzip")) continue;
    return std::none_of(coding.second.begin(), coding.second.end(), [](const auto& parameter) {
      return parameter.first == "q" &&
             parameter.second.find_first_not_of("0.") == boost::core::string_view::npos;
    });
  }
  return false;
}

}  // namespace

bool HostNames::has(std::string_view host) const {
  if (names_.empty()) return true;
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end != std::string_view::npos && names_.contains(host.substr(1, end - 1));
  }
  return names_.contains(host.substr(0, host.find(':')));
}

void set_limits(RequestParser& parser) {
  parser.header_limit(most_head_bytes);
  parser.body_limit(most_body_bytes);
}

std::optional<HttpResponse> refusal_of(const boost::system::error_code& error) {
  if (error == http::error::header_limit || error == http::error::buffer_overflow)
    return problem(431, "head_too_large", "the head of a request has at most 8 KiB");
  if (error == http::error::body_limit)
    return problem(413, "body_too_large", "the body of a request has at most 4 KiB");
  if (error.category() == make_error_code(http::error::bad_method).category() &&
      error != http::error::end_of_stream && error != http::error::partial_message)
    return problem(400, "malformed", "this is no request of HTTP/1.1: " + error.message());
  return std::nullopt;
}

std::optional<HttpResponse> refusal_of(const RequestParser& parser, const HostNames& names) {
  const auto& head = parser.get();
  const bool is_post = head.method() == http::verb::post;
  if (!is_post && head.method() != http::verb::get && head.method() != http::verb::head)
    return problem(405, "method", "GET, HEAD and POST are answered");
  if (head.count(http::field::transfer_encoding) > 0)
    return problem(400, "transfer_encoding", "send the body with Content-Length");
  if (head.count(http::field::content_length) > (is_post ? 1U : 0U) &&
      head[http::field::content_length] != "0")
    return problem(400, "content_length", "a POST has one Content-Length, a GET none");
  if (is_post && head.count(http::field::content_length) == 0)
    return problem(411, "content_length", "a POST has one Content-Length");
  if (head.count(http::field::host) > 1 || !names.has([&head] {
        const auto host = head[http::field::host];
        return std::string_view(host.data(), host.size());
      }()))
    return problem(421, "host",
                   "the page has another name: ask by its address, or start it with --name");
  return std::nullopt;
}

std::variant<HttpRequest, HttpResponse> read_request(const RequestMessage& message,
                                                     const std::string& user_header) {
  const auto url = boost::urls::parse_origin_form(message.target());
  if (!url) return problem(400, "address", "the address cannot be read: begin it with /");
  HttpRequest request;
  request.is_post = message.method() == http::verb::post;
  request.path = url->path();
  for (const auto& parameter : url->params())
    request.query.emplace_back(parameter.key, parameter.value);
  request.body = message.body();
  request.content_type = header(message, "Content-Type");
  request.origin = header(message, "Origin");
  request.host = header(message, "Host");
  request.cookie = header(message, "Cookie");
  request.token = header(message, "X-Reident-Token");
  request.etag = header(message, "If-None-Match");
  request.last_event = header(message, "Last-Event-ID");
  request.accepts_gzip = accepts_gzip(message);
  if (!user_header.empty()) request.user = header(message, user_header);
  return request;
}

ResponseMessage message_of(const HttpResponse& response, bool is_secure) {
  ResponseMessage message{http::int_to_status(static_cast<unsigned>(response.status)), 11};
  for (const auto& [name, value] : headers_of_all)
    message.set(std::string(name), std::string(value));
  if (is_secure) message.set(std::string(header_of_tls.first), std::string(header_of_tls.second));
  message.set(http::field::cache_control, "no-store");
  message.set(http::field::content_type, response.content_type);
  if (response.is_gzip) message.set(http::field::content_encoding, "gzip");
  for (const auto& [name, value] : response.headers) message.set(name, value);
  message.body() = response.body;
  message.prepare_payload();
  return message;
}

std::string event_stream_head(bool is_secure) {
  std::string head =
      "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\n"
      "X-Accel-Buffering: no\r\nConnection: close\r\n";
  const auto add = [&head](const NamedValue& one) {
    head.append(one.first).append(": ").append(one.second).append("\r\n");
  };
  for (const NamedValue& one : headers_of_all) add(one);
  if (is_secure) add(header_of_tls);
  return head + "\r\nretry: 2000\n\n";
}

}  // namespace reident::web
