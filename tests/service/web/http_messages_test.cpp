#include "service/web/http_messages.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace reident::web {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const HostNames any_name({});

/// What is answered to the bytes of a request without asking anything; 0: it is taken; -1: it is
/// incomplete. Where they come one by one they are taken alike, and refused alike or later.
int status_of(const std::string& text, const std::vector<std::string>& names = {}) {
  const HostNames known(names);
  const auto status = [&](std::size_t step) {
    RequestReader reader(known);
    std::string unread;
    bool has_all = false;
    for (std::size_t at = 0; at < text.size() && !has_all; at += step) {
      unread += text.substr(at, step);
      has_all = reader.take(unread);
    }
    if (!has_all) return -1;
    const auto request = reader.request("");
    const auto* refusal = std::get_if<HttpResponse>(&request);
    return refusal != nullptr ? refusal->status : 0;
  };
  const int at_once = status(text.size());
  const int one_by_one = status(1);
  EXPECT_TRUE(one_by_one == at_once || (at_once > 0 && one_by_one == -1)) << text;
  return at_once;
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

std::variant<HttpRequest, HttpResponse> read(const std::string& target,
                                             const std::string& user_header = "") {
  RequestReader reader(any_name);
  std::string bytes = get(target, "X-User: Ana\r\n");
  EXPECT_TRUE(reader.take(bytes));
  return reader.request(user_header);
}

TEST(HttpMessages, ReadTheAddressAndItsParameters) {
  const auto answer = read("/api/v1/x?spacecraft=A%2FB&equipment=%C3%84&empty=&last");
  ASSERT_TRUE(std::holds_alternative<HttpRequest>(answer));
  const auto& request = std::get<HttpRequest>(answer);
  EXPECT_EQ(request.path, "/api/v1/x");
  EXPECT_EQ(request.parameter("spacecraft"), "A/B");
  EXPECT_EQ(request.parameter("equipment"), "\xc3\x84");
  EXPECT_EQ(request.parameter("empty"), "");
  EXPECT_EQ(request.parameter("absent"), "");
  EXPECT_TRUE(std::holds_alternative<HttpResponse>(read("no-slash")));
  EXPECT_TRUE(std::holds_alternative<HttpResponse>(read("/?a=%zz")));
}

TEST(HttpMessages, TrustTheHeaderOfAUserOnlyFromAProxy) {
  EXPECT_EQ(std::get<HttpRequest>(read("/")).user, "");
  EXPECT_EQ(std::get<HttpRequest>(read("/", "X-User")).user, "Ana");
}

TEST(HttpMessages, LeaveToTheNextRequestWhatIsItsOwn) {
  std::string bytes =
      "POST /a HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\n{}HEAD /b HTTP/1.1\r\nHost: a\r\n"
      "Connection: close\r\n\r\nGET /c";
  RequestReader first(any_name), second(any_name), third(any_name);
  ASSERT_TRUE(first.take(bytes));
  EXPECT_EQ(std::get<HttpRequest>(first.request("")).body, "{}");
  EXPECT_TRUE(first.keeps_alive());
  ASSERT_TRUE(second.take(bytes));
  EXPECT_EQ(std::get<HttpRequest>(second.request("")).path, "/b");
  EXPECT_TRUE(second.is_head_only());
  EXPECT_FALSE(second.keeps_alive());
  EXPECT_FALSE(third.take(bytes));
}

TEST(HttpMessages, CarryThePolicyOfContent) {
  HttpResponse response;
  response.body = "{}";
  const std::string head = head_of(response, false, true);
  EXPECT_THAT(head, StartsWith("HTTP/1.1 200 OK\r\n"));
  EXPECT_THAT(head, HasSubstr("default-src 'none'"));
  EXPECT_THAT(head, Not(HasSubstr("unsafe")));
  EXPECT_THAT(head, Not(HasSubstr("Strict-Transport-Security")));
  EXPECT_THAT(head, HasSubstr("\r\nCache-Control: no-store\r\n"));
  EXPECT_THAT(head, HasSubstr("\r\nContent-Length: 2\r\n"));
  EXPECT_THAT(head_of(response, true, true), HasSubstr("Strict-Transport-Security"));
}

TEST(HttpMessages, SayNothingOfABodyThatHasNotChanged) {
  HttpResponse response;
  response.status = 304;
  response.headers = {{"Cache-Control", "no-cache"}};
  const std::string head = head_of(response, false, false);
  EXPECT_THAT(head, StartsWith("HTTP/1.1 304 Not Modified\r\n"));
  EXPECT_THAT(head, Not(AnyOf(HasSubstr("\r\nContent-Type"), HasSubstr("Content-Length"),
                              HasSubstr("no-store"))));
  EXPECT_THAT(head, HasSubstr("\r\nConnection: close\r\n"));
}

}  // namespace
}  // namespace reident::web
