#include "service/web/http_server.hpp"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>
#include <unistd.h>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/serializer.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "service/support/log.hpp"
#include "service/web/http_messages.hpp"

namespace reident::web {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace ssl = boost::asio::ssl;
using asio::awaitable;
using Tcp = asio::ip::tcp;
using Local = asio::local::stream_protocol;
using TcpStream = beast::tcp_stream;
using LocalStream = beast::basic_stream<Local>;
using TlsStream = beast::ssl_stream<TcpStream>;
using namespace std::chrono_literals;

constexpr auto deadline = 10s;             // of a head, a body, an answer
constexpr auto quiet_interval = 15s;       // a stream without events shows that it lives
constexpr int kept_by_system = 128 << 10;  // of an answer to a client that reads slowly
constexpr auto last_wait = 1s;             // for what a refused client still sends
constexpr std::size_t most_thrown_away = 64 << 10;
constexpr auto accept_again_after = 100ms;  // where no descriptor is left
constexpr auto as_tuple = asio::as_tuple(asio::use_awaitable);

/// Who is at the other end of a connection.
struct Peer {
  std::string address;
  std::string user;
  bool is_secure = false;
};

/// The common name of the client's certificate; empty where it sent none.
std::string common_name(SSL* handle) {
  const std::unique_ptr<X509, decltype(&X509_free)> certificate(SSL_get1_peer_certificate(handle),
                                                                X509_free);
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

/// Makes way for a socket: removes one that nobody listens on any more.
void remove_stale_socket(const std::string& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0) return;
  if (!S_ISSOCK(found.st_mode))
    throw ServerError(path + " exists and is no socket: name another path");
  asio::io_context context;
  Local::socket probe(context);
  boost::system::error_code error;
  if (!probe.connect(Local::endpoint(path), error))
    throw ServerError(path + " is in use by another program: end that, or name another path");
  ::unlink(path.c_str());
}

}  // namespace

struct HttpServer::Impl {
  Impl(const ServerOptions& options, Handle handle, EventSource& events);
  ~Impl();

  void listen_tcp();
  void listen_local();
  void load_certificates();

  template <typename Acceptor>
  awaitable<void> accept(Acceptor& acceptor);
  void begin(Tcp::socket socket);
  void begin(Local::socket socket);
  awaitable<void> serve_tls(Tcp::socket socket, std::string address);
  template <typename Stream>
  awaitable<void> serve(Stream& stream, Peer peer);
  /// Ends a connection whose client may still send: a reset would take the answer from it.
  template <typename Stream>
  awaitable<void> end(Stream& stream, beast::flat_buffer& buffer);
  template <typename Stream>
  awaitable<bool> answer_request(Stream& stream, RequestParser& parser, const Peer& peer);
  template <typename Stream>
  awaitable<bool> write(Stream& stream, const HttpResponse& response, bool head_only,
                        bool keep_alive);
  template <typename Stream>
  awaitable<void> stream_events(Stream& stream, std::uint64_t after);
  awaitable<Answer> ask(HttpRequest request);

  /// Holds a place among the connections while it exists.
  class Place {
   public:
    Place(Impl& server, std::string address) : server_(&server), address_(std::move(address)) {
      ++server_->connections;
      ++server_->of_address[address_];
    }
    ~Place() {
      --server_->connections;
      if (const auto found = server_->of_address.find(address_); --found->second == 0)
        server_->of_address.erase(found);
    }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

   private:
    Impl* server_;
    std::string address_;
  };
  bool has_room(const std::string& address) const;

  const ServerOptions options;
  const Handle handle;
  EventSource& events;
  HostNames names;
  std::atomic<std::uint64_t> connections = 0, open_streams = 0, refused = 0, coalesced = 0;
  std::map<std::string, std::size_t> of_address;
  std::set<asio::steady_timer*> streams;  // that wait for events
  std::optional<ssl::context> tls;
  asio::io_context context{1};
  std::optional<Tcp::acceptor> tcp;
  std::optional<Local::acceptor> local;
};

HttpServer::Impl::Impl(const ServerOptions& server_options, Handle on_request, EventSource& source)
    : options(server_options), handle(std::move(on_request)), events(source), names(options.names) {
  try {
    if (!options.certificate.empty()) load_certificates();
    options.socket.empty() ? listen_tcp() : listen_local();
  } catch (const boost::system::system_error& error) {
    throw ServerError(fmt::format("cannot listen on {}: {}; name another address or port",
                                  options.socket.empty()
                                      ? fmt::format("{}:{}", options.address, options.port)
                                      : options.socket,
                                  error.code().message()));
  }
}

HttpServer::Impl::~Impl() {
  if (local) ::unlink(options.socket.c_str());
}

void HttpServer::Impl::load_certificates() {
  tls.emplace(ssl::context::tls_server);
  SSL_CTX_set_min_proto_version(tls->native_handle(), TLS1_2_VERSION);
  const auto load = [](const std::string& file, const auto& use) {
    boost::system::error_code error;
    use(file, error);
    if (error)
      throw ServerError(fmt::format(
          "{} cannot be used: {}; name a PEM file that this user can read", file, error.message()));
  };
  load(options.certificate, [this](const std::string& file, auto& error) {
    tls->use_certificate_chain_file(file, error);
  });
  load(options.key.empty() ? options.certificate : options.key,
       [this](const std::string& file, auto& error) {
         tls->use_private_key_file(file, ssl::context::pem, error);
       });
  if (options.client_authority.empty()) return;
  load(options.client_authority,
       [this](const std::string& file, auto& error) { tls->load_verify_file(file, error); });
  tls->set_verify_mode(ssl::verify_peer | ssl::verify_fail_if_no_peer_cert);
}

void HttpServer::Impl::listen_tcp() {
  boost::system::error_code error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error)
    throw ServerError(options.address + " is no IP address: give one, such as 127.0.0.1 or ::1");
  if (!address.is_loopback() && !tls)
    throw ServerError(
        fmt::format("{} is not loopback, and there is no certificate: anybody on the way could "
                    "read and change what operators see. Give --certificate and --key, listen on "
                    "127.0.0.1, or on a Unix socket behind a proxy",
                    options.address));
  const Tcp::endpoint endpoint(address, options.port);
  tcp.emplace(context, endpoint.protocol());
  tcp->set_option(asio::socket_base::reuse_address(true));
  tcp->bind(endpoint);
  tcp->listen();
  names.add(options.address);
  if (address.is_loopback()) names.add("localhost");
}

void HttpServer::Impl::listen_local() {
  if (options.socket.size() >= sizeof(sockaddr_un::sun_path))
    throw ServerError(options.socket + " is too long for a socket: name a shorter path");
  remove_stale_socket(options.socket);
  local.emplace(context, Local::endpoint(options.socket));
  ::chmod(options.socket.c_str(), S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP);
}

bool HttpServer::Impl::has_room(const std::string& address) const {
  if (connections >= options.connections) return false;
  const auto found = of_address.find(address);
  return local || found == of_address.end() || found->second < options.connections_of_address;
}

template <typename Acceptor>
awaitable<void> HttpServer::Impl::accept(Acceptor& acceptor) {
  for (;;) {
    auto [error, socket] = co_await acceptor.async_accept(as_tuple);
    if (error == asio::error::operation_aborted) co_return;
    if (error) {
      asio::steady_timer pause(context, accept_again_after);
      co_await pause.async_wait(as_tuple);
      continue;
    }
    begin(std::move(socket));
  }
}

void HttpServer::Impl::begin(Tcp::socket socket) {
  boost::system::error_code error;
  const std::string address = socket.remote_endpoint(error).address().to_string();
  if (error || !has_room(address)) {
    ++refused;
    return;
  }
  socket.set_option(Tcp::no_delay(true), error);
  socket.set_option(asio::socket_base::send_buffer_size(kept_by_system), error);
  if (tls) {
    asio::co_spawn(context, serve_tls(std::move(socket), address), asio::detached);
    return;
  }
  asio::co_spawn(
      context,
      [](Impl& server, Tcp::socket connection, std::string from) -> awaitable<void> {
        const Place place(server, from);
        TcpStream stream(std::move(connection));
        Peer peer{from, "", false};  // g++ 12 destroys a temporary in a co_await twice
        co_await server.serve(stream, std::move(peer));
      }(*this, std::move(socket), address),
      asio::detached);
}

void HttpServer::Impl::begin(Local::socket socket) {
  if (!has_room("unix")) {
    ++refused;
    return;
  }
  asio::co_spawn(
      context,
      [](Impl& server, Local::socket connection) -> awaitable<void> {
        const Place place(server, "unix");
        LocalStream stream(std::move(connection));
        Peer peer{"unix", "", false};
        co_await server.serve(stream, std::move(peer));
      }(*this, std::move(socket)),
      asio::detached);
}

awaitable<void> HttpServer::Impl::serve_tls(Tcp::socket socket, std::string address) {
  const Place place(*this, address);
  TlsStream stream(TcpStream(std::move(socket)), *tls);
  beast::get_lowest_layer(stream).expires_after(deadline);
  const auto [error] = co_await stream.async_handshake(ssl::stream_base::server, as_tuple);
  if (error) co_return;
  Peer peer{address, common_name(stream.native_handle()), true};
  co_await serve(stream, std::move(peer));
}

template <typename Stream>
awaitable<void> HttpServer::Impl::serve(Stream& stream, Peer peer) {
  beast::flat_buffer buffer(most_head_bytes + most_body_bytes);
  for (bool go_on = true; go_on;) {
    RequestParser parser;
    set_limits(parser);
    beast::get_lowest_layer(stream).expires_after(deadline);
    const auto [error, bytes] = co_await http::async_read_header(stream, buffer, parser, as_tuple);
    auto refusal = error ? refusal_of(error) : refusal_of(parser, names);
    if (error && !refusal) co_return;
    if (!refusal) {
      beast::get_lowest_layer(stream).expires_after(deadline);
      const auto [body_error, body_bytes] =
          co_await http::async_read(stream, buffer, parser, as_tuple);
      if (body_error) refusal = refusal_of(body_error);
      if (body_error && !refusal) co_return;
    }
    if (refusal) {
      if (co_await write(stream, *refusal, false, false)) co_await end(stream, buffer);
      co_return;
    }
    go_on = co_await answer_request(stream, parser, peer);
  }
}

template <typename Stream>
awaitable<void> HttpServer::Impl::end(Stream& stream, beast::flat_buffer& buffer) {
  auto& below = beast::get_lowest_layer(stream);
  boost::system::error_code failure;
  below.socket().shutdown(asio::socket_base::shutdown_send, failure);
  below.expires_after(last_wait);
  for (std::size_t taken = 0; !failure && taken < most_thrown_away;) {
    buffer.clear();
    const auto [error, bytes] = co_await below.async_read_some(buffer.prepare(4096), as_tuple);
    failure = error;
    taken += bytes;
  }
}

template <typename Stream>
awaitable<bool> HttpServer::Impl::answer_request(Stream& stream, RequestParser& parser,
                                                 const Peer& peer) {
  const bool keep_alive = parser.get().keep_alive();
  const bool head_only = parser.get().method() == http::verb::head;
  auto read = read_request(parser.get(), local ? options.user_header : "");
  if (auto* refusal = std::get_if<HttpResponse>(&read)) {
    co_await write(stream, *refusal, head_only, false);
    co_return false;
  }
  auto& request = std::get<HttpRequest>(read);
  request.peer = peer.address;
  request.is_secure = peer.is_secure;
  if (!peer.user.empty()) request.user = peer.user;
  const Answer answer = co_await ask(std::move(request));
  if (const auto* response = std::get_if<HttpResponse>(&answer))
    co_return co_await write(stream, *response, head_only, keep_alive) && keep_alive;
  co_await stream_events(stream, std::get<EventStream>(answer).after);
  co_return false;
}

awaitable<Answer> HttpServer::Impl::ask(HttpRequest request) {
  struct Pending {
    explicit Pending(asio::io_context& network)
        : ready(network, asio::steady_timer::time_point::max()) {}
    asio::steady_timer ready;
    std::optional<Answer> answer;
  };
  const auto pending = std::make_shared<Pending>(context);
  handle(std::move(request), [this, pending](Answer answer) {
    asio::post(context, [pending, answer = std::move(answer)]() mutable {
      if (pending->answer) return;
      pending->answer = std::move(answer);
      pending->ready.cancel();
    });
  });
  while (!pending->answer) co_await pending->ready.async_wait(as_tuple);
  co_return *std::move(pending->answer);
}

template <typename Stream>
awaitable<bool> HttpServer::Impl::write(Stream& stream, const HttpResponse& response,
                                        bool head_only, bool keep_alive) {
  auto message = message_of(response, tls.has_value());
  message.keep_alive(keep_alive);
  http::response_serializer<http::string_body> serializer(message);
  beast::get_lowest_layer(stream).expires_after(deadline);
  if (head_only) {
    const auto [error, bytes] = co_await http::async_write_header(stream, serializer, as_tuple);
    co_return !error;
  }
  const auto [error, bytes] = co_await http::async_write(stream, serializer, as_tuple);
  co_return !error;
}

template <typename Stream>
awaitable<void> HttpServer::Impl::stream_events(Stream& stream, std::uint64_t after) {
  asio::steady_timer wake(context);
  struct Entry {
    Entry(Impl& of, asio::steady_timer& timer) : server(of), wakes(timer) {
      server.streams.insert(&wakes);
      ++server.open_streams;
    }
    ~Entry() {
      server.streams.erase(&wakes);
      --server.open_streams;
    }
    Impl& server;
    asio::steady_timer& wakes;
  } entry(*this, wake);
  std::string text = event_stream_head(tls.has_value());
  for (bool has_begun = false;; has_begun = true) {
    EventSource::Events news = events.since(after);
    after = news.revision;
    coalesced += has_begun ? news.coalesced : 0;
    text += news.text;
    if (text.empty()) {
      wake.expires_after(quiet_interval);
      const auto [woken] = co_await wake.async_wait(as_tuple);
      if (woken) continue;
      text = ": nothing new\n\n";
    }
    beast::get_lowest_layer(stream).expires_after(deadline);
    const auto [error, bytes] = co_await asio::async_write(stream, asio::buffer(text), as_tuple);
    if (error) co_return;
    text.clear();
  }
}

HttpServer::HttpServer(const ServerOptions& options, Handle handle, EventSource& events)
    : impl_(std::make_unique<Impl>(options, std::move(handle), events)) {
  if (impl_->tcp) asio::co_spawn(impl_->context, impl_->accept(*impl_->tcp), asio::detached);
  if (impl_->local) asio::co_spawn(impl_->context, impl_->accept(*impl_->local), asio::detached);
}

HttpServer::~HttpServer() = default;

std::string HttpServer::url() const {
  if (impl_->local) return "unix:" + impl_->options.socket;
  const std::string& address = impl_->options.address;
  return fmt::format("{}://{}:{}/", impl_->tls ? "https" : "http",
                     address.find(':') == std::string::npos ? address : "[" + address + "]",
                     impl_->tcp->local_endpoint().port());
}

void HttpServer::run() {
  impl_->context.run();
}

void HttpServer::stop() {
  impl_->context.stop();
}

void HttpServer::notify() {
  asio::post(impl_->context, [this] {
    for (asio::steady_timer* wake : impl_->streams) wake->cancel();
  });
}

ServerCounts HttpServer::counts() const {
  return {impl_->connections, impl_->open_streams, impl_->refused, impl_->coalesced};
}

}  // namespace reident::web
