#include "service/web/http_server.hpp"

#include <array>
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
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/un.h>

#include "service/support/log.hpp"
#include "service/web/http_connection.hpp"
#include "service/web/http_messages.hpp"

namespace reident::web {
namespace {

namespace asio = boost::asio;
namespace ssl = boost::asio::ssl;
using asio::awaitable;
using Tcp = asio::ip::tcp;
using Local = asio::local::stream_protocol;
using namespace std::chrono_literals;

constexpr auto deadline = 10s;              // of a handshake, a request, an answer
constexpr auto quiet_interval = 15s;        // a stream without events shows that it lives
constexpr int kept_by_system = 128 << 10;   // of an answer to a client that reads slowly
constexpr auto accept_again_after = 100ms;  // where no descriptor is left
constexpr auto as_tuple = asio::as_tuple(asio::use_awaitable);

/// Who is at the other end of a connection.
struct Peer {
  std::string address;  // "unix" of a Unix socket
  bool is_secure = false;
  std::string user{};  // by the client's certificate; empty: none
};

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
  awaitable<void> serve(std::unique_ptr<Connection> connection, Peer peer);
  /// False where the connection ended first.
  awaitable<bool> read(Connection& connection, RequestReader& reader, std::string& unread);
  /// Whether the connection goes on.
  awaitable<bool> answer(Connection& connection, const RequestReader& reader, const Peer& peer);
  awaitable<bool> write(Connection& connection, std::string_view text);
  awaitable<void> stream_events(Connection& connection, std::uint64_t after);
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
  auto connection =
      tls ? tls_connection_over(std::move(socket), *tls) : connection_over(std::move(socket));
  asio::co_spawn(context, serve(std::move(connection), Peer{address, tls.has_value()}),
                 asio::detached);
}

void HttpServer::Impl::begin(Local::socket socket) {
  if (!has_room("unix")) {
    ++refused;
    return;
  }
  asio::co_spawn(context, serve(connection_over(std::move(socket)), Peer{"unix"}), asio::detached);
}

awaitable<void> HttpServer::Impl::serve(std::unique_ptr<Connection> connection, Peer peer) {
  const Place place(*this, peer.address);
  connection->expires_after(deadline);
  if (!co_await connection->begin()) co_return;
  peer.user = connection->common_name();
  std::string unread;
  for (bool go_on = true; go_on;) {
    RequestReader reader(names);
    connection->expires_after(deadline);
    if (!co_await read(*connection, reader, unread)) co_return;
    go_on = co_await answer(*connection, reader, peer);
  }
  co_await connection->end();
}

awaitable<bool> HttpServer::Impl::read(Connection& connection, RequestReader& reader,
                                       std::string& unread) {
  std::array<char, 4096> room;
  while (!reader.take(unread)) {
    const std::size_t bytes = co_await connection.read_some(room);
    if (bytes == 0) co_return false;
    unread.append(room.data(), bytes);
  }
  co_return true;
}

awaitable<bool> HttpServer::Impl::answer(Connection& connection, const RequestReader& reader,
                                         const Peer& peer) {
  auto read = reader.request(local ? options.user_header : "");
  auto* request = std::get_if<HttpRequest>(&read);
  Answer result;
  if (request != nullptr) {
    request->peer = peer.address;
    request->is_secure = peer.is_secure;
    if (!peer.user.empty()) request->user = peer.user;
    result = co_await ask(std::move(*request));
  } else {
    result = std::get<HttpResponse>(std::move(read));
  }
  if (const auto* begins = std::get_if<EventStream>(&result)) {
    co_await stream_events(connection, begins->after);
    co_return false;
  }
  const auto& response = std::get<HttpResponse>(result);
  const bool keeps_alive = request != nullptr && reader.keeps_alive();
  std::string text = head_of(response, peer.is_secure, keeps_alive);
  if (!reader.is_head_only()) text += response.body;
  connection.expires_after(deadline);
  co_return co_await write(connection, text) && keeps_alive;
}

awaitable<bool> HttpServer::Impl::write(Connection& connection, std::string_view text) {
  while (!text.empty()) {
    const std::size_t bytes = co_await connection.write_some(text);
    if (bytes == 0) co_return false;
    text.remove_prefix(bytes);
  }
  co_return true;
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

awaitable<void> HttpServer::Impl::stream_events(Connection& connection, std::uint64_t after) {
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
    connection.expires_after(deadline);
    if (!co_await write(connection, text)) co_return;
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
