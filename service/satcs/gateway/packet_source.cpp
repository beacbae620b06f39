#include "service/satcs/gateway/packet_source.hpp"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <poll.h>
#include <stdexcept>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <netinet/in.h>
#include <sys/socket.h>

namespace reident::satcs {
namespace {

constexpr int wait_ms = 100;
constexpr std::size_t chunk_bytes = std::size_t{1} << 18;
constexpr std::size_t datagram_bytes = 65'536;
constexpr int receive_buffer = 8 << 20;  // while an archive is waited for

[[noreturn]] void fail(const std::string& what, const std::string& remedy) {
  const int code = errno;
  throw std::runtime_error(what + ": " + std::error_code(code, std::generic_category()).message() +
                           "; " + remedy);
}

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    close();
    number_ = std::exchange(other.number_, -1);
    return *this;
  }
  int get() const { return number_; }
  explicit operator bool() const { return number_ >= 0; }

 private:
  void close() {
    if (number_ >= 0) ::close(number_);
    number_ = -1;
  }
  int number_ = -1;
};

bool is_ready(const Descriptor& descriptor) {
  pollfd wanted{descriptor.get(), POLLIN, 0};
  return ::poll(&wanted, 1, wait_ms) > 0;
}

/// Bytes read; 0 at the end, and -1 where there was nothing after all.
ssize_t read_into(const Descriptor& descriptor, std::vector<std::uint8_t>& bytes, std::size_t most,
                  const std::string& name) {
  bytes.resize(most);
  const ssize_t count = ::read(descriptor.get(), bytes.data(), bytes.size());
  if (count < 0 && errno != EINTR && errno != EAGAIN && errno != ECONNRESET)
    fail(name + " cannot be read", "look at the device, or at who sends");
  const bool is_reset = count < 0 && errno == ECONNRESET;
  bytes.resize(count < 0 ? 0 : static_cast<std::size_t>(count));
  return is_reset ? 0 : count;
}

class FileSource : public PacketSource {
 public:
  explicit FileSource(const std::filesystem::path& file) : name_(file.string()) {
    if (file == "-") {
      file_ = Descriptor(::dup(STDIN_FILENO));
      name_ = "standard input";
    } else {
      std::error_code none;
      if (std::filesystem::is_directory(file, none))
        throw std::runtime_error(name_ + ": is a folder; give the file of packets");
      file_ = Descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
      const auto size = std::filesystem::file_size(file, none);
      if (!none) size_ = size;
    }
    if (!file_) fail(name_ + " cannot be opened", "check the path");
  }

  Got read(std::vector<std::uint8_t>& bytes) override {
    if (!is_ready(file_)) return Got::nothing;
    const ssize_t count = read_into(file_, bytes, chunk_bytes, name_);
    if (count < 0) return Got::nothing;
    done_ += bytes.size();
    return count == 0 ? Got::end : Got::bytes;
  }
  bool is_live() const override { return false; }
  double progress() const override {
    return size_ == 0 ? 0 : static_cast<double>(done_) / static_cast<double>(size_);
  }

 private:
  std::string name_;
  Descriptor file_;
  std::uintmax_t size_ = 0;
  std::uintmax_t done_ = 0;
};

Descriptor bound(int type, std::uint16_t port) {
  const std::string name = "port " + std::to_string(port) + " of 127.0.0.1";
  Descriptor socket(::socket(AF_INET, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!socket) fail(name + " cannot be opened", "raise the limit of open files");
  const int yes = 1;
  if (type == SOCK_STREAM) ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      (type == SOCK_STREAM && ::listen(socket.get(), 1) != 0))
    fail(name + " cannot be had", "give another port, or stop who has it");
  return socket;
}

class UdpSource : public PacketSource {
 public:
  explicit UdpSource(std::uint16_t port) : socket_(bound(SOCK_DGRAM, port)) {}

  Got read(std::vector<std::uint8_t>& bytes) override {
    if (!is_ready(socket_)) return Got::nothing;
    return read_into(socket_, bytes, datagram_bytes, "the port") < 0 ? Got::nothing : Got::whole;
  }
  bool is_live() const override { return true; }

 private:
  Descriptor socket_;
};

class TcpSource : public PacketSource {
 public:
  explicit TcpSource(std::uint16_t port) : listener_(bound(SOCK_STREAM, port)) {}

  Got read(std::vector<std::uint8_t>& bytes) override {
    bytes.clear();
    if (!sender_) {
      if (is_ready(listener_))
        sender_ = Descriptor(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
      return Got::nothing;
    }
    if (!is_ready(sender_)) return Got::nothing;
    const ssize_t count = read_into(sender_, bytes, chunk_bytes, "the connection");
    if (count < 0) return Got::nothing;
    if (count > 0) return Got::bytes;
    sender_ = {};
    return Got::whole;
  }
  bool is_live() const override { return true; }

 private:
  Descriptor listener_;
  Descriptor sender_;
};

}  // namespace

std::unique_ptr<PacketSource> file_source(const std::filesystem::path& file) {
  return std::make_unique<FileSource>(file);
}

std::unique_ptr<PacketSource> udp_source(std::uint16_t port) {
  return std::make_unique<UdpSource>(port);
}

std::unique_ptr<PacketSource> tcp_source(std::uint16_t port) {
  return std::make_unique<TcpSource>(port);
}

}  // namespace reident::satcs
