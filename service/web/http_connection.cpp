#include "service/web/http_connection.hpp"

#include <array>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/tcp_stream.hpp>

namespace reident::web {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::awaitable;
using TlsStream = asio::ssl::stream<beast::tcp_stream>;
using namespace std::chrono_literals;

constexpr auto last_wait = 1s;  // for what the client still sends
constexpr std::size_t most_thrown_away = 64 << 10;
constexpr auto with_error = asio::as_tuple(asio::use_awaitable);

template <typename Stream>
class Over : public Connection {
 public:
  template <typename... Arguments>
  explicit Over(Arguments&&... arguments) : stream_(std::forward<Arguments>(arguments)...) {}

  void expires_after(std::chrono::steady_clock::duration time) override {
    below().expires_after(time);
  }

  awaitable<bool> begin() override { co_return true; }

  awaitable<std::size_t> read_some(std::span<char> room) override {
    const auto [error, bytes] =
        co_await stream_.async_read_some(asio::buffer(room.data(), room.size()), with_error);
    co_return error ? 0 : bytes;
  }

  awaitable<std::size_t> write_some(std::string_view text) override {
    const auto [error, bytes] =
        co_await stream_.async_write_some(asio::buffer(text.data(), text.size()), with_error);
    co_return error ? 0 : bytes;
  }

  awaitable<void> end() override {
    boost::system::error_code failure;
    below().socket().shutdown(asio::socket_base::shutdown_send, failure);
    below().expires_after(last_wait);
    std::array<char, 4096> room;
    for (std::size_t taken = 0; !failure && taken < most_thrown_away;) {
      const auto [error, bytes] = co_await below().async_read_some(asio::buffer(room), with_error);
      failure = error;
      taken += bytes;
    }
  }

  std::string common_name() override { return ""; }

 protected:
  auto& below() { return beast::get_lowest_layer(stream_); }
  Stream stream_;
};

class OverTls : public Over<TlsStream> {
 public:
  using Over::Over;

  awaitable<bool> begin() override {
    const auto [error] =
        co_await stream_.async_handshake(asio::ssl::stream_base::server, with_error);
    co_return !error;
  }

  std::string common_name() override {
    const std::unique_ptr<X509, decltype(&X509_free)> certificate(
        SSL_get1_peer_certificate(stream_.native_handle()), X509_free);
    if (!certificate) return "";
    X509_NAME* subject = X509_get_subject_name(certificate.get());
    const int at = X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
    if (at < 0) return "";
    unsigned char* text = nullptr;
    const int length =
        ASN1_STRING_to_UTF8(&text, X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at)));
    if (length < 0) return "";
    const std::string name(reinterpret_cast<char*>(text), static_cast<std::size_t>(length));
    OPENSSL_free(text);
    return name;
  }
};

}  // namespace

std::unique_ptr<Connection> connection_over(asio::ip::tcp::socket socket) {
  return std::make_unique<Over<beast::tcp_stream>>(std::move(socket));
}

std::unique_ptr<Connection> connection_over(asio::local::stream_protocol::socket socket) {
  return std::make_unique<Over<beast::basic_stream<asio::local::stream_protocol>>>(
      std::move(socket));
}

std::unique_ptr<Connection> tls_connection_over(asio::ip::tcp::socket socket,
                                                asio::ssl::context& tls) {
  return std::make_unique<OverTls>(beast::tcp_stream(std::move(socket)), tls);
}

}  // namespace reident::web
