// Between the bytes of HTTP/1.1 and HttpRequest and HttpResponse: what is refused, what is read,
// what every answer carries. Knows no socket; private to the server.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/web/http.hpp"

namespace reident::web {

inline constexpr std::size_t most_head_bytes = 8 << 10;
inline constexpr std::size_t most_body_bytes = 4 << 10;

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

/// One request, from its bytes as they come.
class RequestReader {
 public:
  explicit RequestReader(const HostNames& names);  // which has to outlive it
  ~RequestReader();

  /// Takes what is the request's from the front of `bytes`; the rest belongs to the next one. False
  /// while it needs more. A head is refused before its body is there.
  bool take(std::string& bytes);
  /// Once it has all: the request, or the answer to one that is refused. `user_header`: a trusted
  /// proxy's, or empty.
  std::variant<HttpRequest, HttpResponse> request(const std::string& user_header) const;
  bool is_head_only() const;
  bool keeps_alive() const;

 private:
  struct Parser;
  const HostNames* names_;
  std::unique_ptr<Parser> parser_;
  std::optional<HttpResponse> refusal_;
};

/// The head of an answer with a body of known length, and its last line end.
std::string head_of(const HttpResponse& response, bool is_secure, bool keeps_alive);
/// The head of an answer that ends with its connection.
std::string event_stream_head(bool is_secure);

}  // namespace reident::web
