// The page's server: HTTP/1.1 on one thread, with bounds on all that a client may cost.
//
//   request               within 10 s of the connection or of the answer before
//   its head              8 KiB
//   its body              4 KiB, of POST alone, with one Content-Length; every Transfer-Encoding is
//                         refused, so that no two programs read one request in two ways
//   answer                taken within 10 s, or the connection ends; so is each server-sent event
//   connections           in all and by address; one more is closed at once
//   a host of another name than the server's is refused: a page elsewhere whose name leads here
//   could read it otherwise
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "service/web/http.hpp"

namespace reident::web {

/// The server cannot start; says why and what would mend it.
class ServerError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ServerOptions {
  std::string address = "127.0.0.1";  // of TCP
  std::uint16_t port = 0;             // 0: any that is free
  std::string socket;                 // path of a Unix socket, in the place of TCP
  std::string certificate, key;       // PEM files: TLS
  std::string client_authority;       // PEM file: clients have certificates of it; needs TLS
  std::string user_header;            // a trusted proxy's, on the Unix socket alone
  std::vector<std::string> names;     // that the server is asked by, in addition to its address
  std::size_t connections = 1024;
  std::size_t connections_of_address = 512;
};

/// What the server counts.
struct ServerCounts {
  std::uint64_t connections = 0;  // now
  std::uint64_t streams = 0;      // of them, that get events
  std::uint64_t refused = 0;      // connections beyond a limit
  std::uint64_t coalesced = 0;    // revisions that a stream did not get, since a newer one came
};

/// What streams get. Called on the network thread alone.
class EventSource {
 public:
  struct Events {
    std::uint64_t revision = 0;
    std::string text;             // of server-sent events; empty: nothing is new
    std::uint64_t coalesced = 0;  // changes in between that it leaves out
  };
  virtual ~EventSource() = default;
  /// What is new since `revision`, each thing once, as it is now.
  virtual Events since(std::uint64_t revision) = 0;
};

class HttpServer {
 public:
  /// Called on the network thread for each request; may not block.
  using Handle = std::function<void(HttpRequest&&, Respond)>;

  /// Listens. An address that is not loopback without TLS is refused, and so are files that cannot
  /// be read. `events` has to outlive it. Throws ServerError.
  HttpServer(const ServerOptions& options, Handle handle, EventSource& events);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  /// Where it listens, as a browser is given it.
  std::string url() const;
  /// Serves until stop().
  void run();
  /// From any thread.
  void stop();
  /// From any thread: events are new.
  void notify();
  ServerCounts counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reident::web
