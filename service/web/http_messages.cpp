#include "service/web/http_messages.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/url/parse.hpp>
#include <boost/url/url_view.hpp>
#include <fmt/format.h>

namespace reident::web {
namespace {

namespace http = boost::beast::http;

using RequestMessage = http::request<http::string_body>;
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

std::string header(const RequestMessage& message, std::string_view name) {
  const auto value = message[boost::core::string_view(name.data(), name.size())];
  return {value.data(), value.size()};
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

/// The answer to a request that cannot be read.
HttpResponse refusal_of(const boost::system::error_code& error) {
  if (error == http::error::header_limit)
    return problem(431, "head_too_large", "the head of a request has at most 8 KiB");
  if (error == http::error::body_limit)
    return problem(413, "body_too_large", "the body of a request has at most 4 KiB");
  return problem(400, "malformed", "this is no request of HTTP/1.1: " + error.message());
}

/// The answer to a head that is refused; absent where it is not.
std::optional<HttpResponse> refusal_of(const RequestMessage& head, const HostNames& names) {
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

void add(std::string& head, const NamedValue& one) {
  head.append(one.first).append(": ").append(one.second).append("\r\n");
}

void add_headers_of_all(std::string& head, bool is_secure) {
  for (const NamedValue& one : headers_of_all) add(head, one);
  if (is_secure) add(head, header_of_tls);
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

struct RequestReader::Parser : http::request_parser<http::string_body> {};

RequestReader::RequestReader(const HostNames& names)
    : names_(&names), parser_(std::make_unique<Parser>()) {
  parser_->header_limit(most_head_bytes);
  parser_->body_limit(most_body_bytes);
}

RequestReader::~RequestReader() = default;

bool RequestReader::take(std::string& bytes) {
  while (!refusal_ && !parser_->is_done()) {
    if (bytes.empty()) return false;
    const bool had_head = parser_->is_header_done();
    boost::system::error_code error;
    bytes.erase(0, parser_->put(boost::asio::buffer(bytes), error));
    if (error == http::error::need_more) return false;
    if (error)
      refusal_ = refusal_of(error);
    else if (!had_head && parser_->is_header_done())
      refusal_ = refusal_of(parser_->get(), *names_);
  }
  return true;
}

bool RequestReader::is_head_only() const {
  return parser_->get().method() == http::verb::head;
}

bool RequestReader::keeps_alive() const {
  return parser_->get().keep_alive();
}

std::variant<HttpRequest, HttpResponse> RequestReader::request(
    const std::string& user_header) const {
  if (refusal_) return *refusal_;
  const RequestMessage& message = parser_->get();
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

std::string head_of(const HttpResponse& response, bool is_secure, bool keeps_alive) {
  const auto reason =
      http::obsolete_reason(http::int_to_status(static_cast<unsigned>(response.status)));
  std::string head = fmt::format("HTTP/1.1 {} {}\r\n", response.status,
                                 std::string_view(reason.data(), reason.size()));
  add_headers_of_all(head, is_secure);
  for (const auto& [name, value] : response.headers) add(head, {name, value});
  if (std::none_of(response.headers.begin(), response.headers.end(),
                   [](const auto& header) { return header.first == "Cache-Control"; }))
    add(head, {"Cache-Control", "no-store"});
  if (response.is_gzip) add(head, {"Content-Encoding", "gzip"});
  if (response.status != 304) {
    add(head, {"Content-Type", response.content_type});
    add(head, {"Content-Length", std::to_string(response.body.size())});
  }
  if (!keeps_alive) add(head, {"Connection", "close"});
  return head + "\r\n";
}

std::string event_stream_head(bool is_secure) {
  std::string head =
      "HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\n"
      "X-Accel-Buffering: no\r\nConnection: close\r\n";
  add_headers_of_all(head, is_secure);
  return head + "\r\nretry: 2000\n\n";
}

}  // namespace reident::web
