// A client's connection, whatever carries it: TCP, TLS or a Unix socket. Private to the server,
// which is compiled once for all three.
#pragma once

#include <chrono>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/ssl/context.hpp>

namespace reident::web {

class Connection {
 public:
  virtual ~Connection() = default;
  /// Sets when what follows fails, and the connection ends: after `time`, until it is set again.
  virtual void expires_after(std::chrono::steady_clock::duration time) = 0;
  /// Before anything is read or written; false where client and server cannot agree.
  virtual boost::asio::awaitable<bool> begin() = 0;
  /// How many bytes came into `room`, at least one; 0 where the connection has ended.
  virtual boost::asio::awaitable<std::size_t> read_some(std::span<char> room) = 0;
  /// How many bytes of the front of `text` went, at least one; 0 where the connection has ended.
  virtual boost::asio::awaitable<std::size_t> write_some(std::string_view text) = 0;
  /// Ends it although the client may still send: a reset would take the last answer from it.
  virtual boost::asio::awaitable<void> end() = 0;
  /// The common name of the client's certificate; empty where it sent none.
  virtual std::string common_name() = 0;
};

std::unique_ptr<Connection> connection_over(boost::asio::ip::tcp::socket socket);
std::unique_ptr<Connection> connection_over(boost::asio::local::stream_protocol::socket socket);
std::unique_ptr<Connection> tls_connection_over(boost::asio::ip::tcp::socket socket,
                                                boost::asio::ssl::context& tls);

}  // namespace reident::web
