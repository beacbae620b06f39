#include "service/web/http_messages.hpp"

#include <string>

#include <boost/asio/buffer.hpp>
#include <gtest/gtest.h>

namespace reident::web {
namespace {

namespace http = boost::beast::http;

/// What the server answers to the bytes of a request without asking anything; 0: it is taken.
int status_of(const std::string& text, const std::vector<std::string>& names = {}) {
  RequestParser parser;
  set_limits(parser);
  parser.eager(true);
  boost::system::error_code error;
  parser.put(boost::asio::buffer(text), error);
  if (error == http::error::need_more) return -1;
  if (error) {
    const auto refusal = refusal_of(error);
    return refusal ? refusal->status : -1;
  }
  const auto refusal = refusal_of(parser, HostNames(names));
  return refusal ? refusal->status : 0;
}

std::string get(const std::string& target, const std::string& more = "") {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n" + more + "\r\n";
}

TEST(HttpMessages, RefuseWhatTwoProgramsCouldReadInTwoWays) {
  struct Case {
    std::string request;
    int status;
  };
  const std::string post = "POST /api/v1/orders HTTP/1.1\r\nHost: localhost\r\n";
  for (const Case& one : {
           Case{get("/"), 0},
           Case{get("/", "Transfer-Encoding: chunked\r\n"), 400},
           Case{post + "Transfer-Encoding: chunked\r\nContent-Length: 2\r\n\r\n{}", 400},
           Case{post + "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400},
           Case{get("/", "Content-Length: 2\r\n") + "{}", 400},
           Case{post + "\r\n", 411},
           Case{post + "Content-Length: 2\r\n\r\n{}", 0},
           Case{post + "Content-Length: 2\r\nContent-Length: 3\r\n\r\n{}", 400},
           Case{"PUT / HTTP/1.1\r\nHost: localhost\r\n\r\n", 405},
           Case{"GET / HTTP/1.1\nHost: localhost\n\n", 400},
           Case{"GET\r\n\r\n", 400},
           Case{std::string("GET /\0 HTTP/1.1\r\n\r\n", 19), 400},
       })
    EXPECT_EQ(status_of(one.request), one.status) << one.request;
}

TEST(HttpMessages, BoundTheHeadAndTheBody) {
  EXPECT_EQ(status_of(get("/" + std::string(most_head_bytes, 'a'))), 431);
  EXPECT_EQ(status_of(get("/", "X: " + std::string(most_head_bytes, 'a') + "\r\n")), 431);
  EXPECT_EQ(status_of("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4097\r\n\r\n" +
                      std::string(4097, 'a')),
            413);
}

TEST(HttpMessages, AnswerToTheirOwnNamesAlone) {
  const std::vector<std::string> names = {"127.0.0.1", "localhost", "::1", "ops.example"};
  const auto asked_by = [&](const std::string& host) {
    return status_of("GET / HTTP/1.1\r\nHost: " + host + "\r\n\r\n", names);
  };
  for (const char* host : {"127.0.0.1:8480", "localhost", "[::1]:8480", "ops.example:443"})
    EXPECT_EQ(asked_by(host), 0) << host;
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "[::2]", "[::1", ""})
    EXPECT_EQ(asked_by(host), 421) << host;
}

RequestMessage message(const std::string& target, const std::string& user = "") {
  RequestMessage request{http::verb::get, target, 11};
  if (!user.empty()) request.set("X-User", user);
  return request;
}

TEST(HttpMessages, ReadTheAddressAndItsParameters) {
  const auto read =
      read_request(message("/api/v1/x?spacecraft=A%2FB&equipment=%C3%84&empty=&last"), "");
  ASSERT_TRUE(std::holds_alternative<HttpRequest>(read));
  const auto& request = std::get<HttpRequest>(read);
  EXPECT_EQ(request.path, "/api/v1/x");
  EXPECT_EQ(request.parameter("spacecraft"), "A/B");
  EXPECT_EQ(request.parameter("equipment"), "\xc3\x84");
  EXPECT_EQ(request.parameter("empty"), "");
  EXPECT_EQ(request.parameter("absent"), "");
  EXPECT_TRUE(std::holds_alternative<HttpResponse>(read_request(message("no-slash"), "")));
  EXPECT_TRUE(std::holds_alternative<HttpResponse>(read_request(message("/?a=%zz"), "")));
}

TEST(HttpMessages, TrustTheHeaderOfAUserOnlyFromAProxy) {
  EXPECT_EQ(std::get<HttpRequest>(read_request(message("/", "Ana"), "")).user, "");
  EXPECT_EQ(std::get<HttpRequest>(read_request(message("/", "Ana"), "X-User")).user, "Ana");
}

TEST(HttpMessages, CarryThePolicyOfContent) {
  HttpResponse response;
  response.body = "{}";
  const auto message = message_of(response, false);
  const std::string policy(message["Content-Security-Policy"]);
  EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(policy.find("unsafe"), std::string::npos);
  EXPECT_EQ(message["Strict-Transport-Security"], "");
  EXPECT_NE(message_of(response, true)["Strict-Transport-Security"], "");
}

}  // namespace
}  // namespace reident::web
