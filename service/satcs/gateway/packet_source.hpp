// Where the bytes of packets come from: a file, standard input, or a port of this machine.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace reident::satcs {

class PacketSource {
 public:
  enum class Got {
    bytes,  // more of the same stream may follow
    whole,  // bytes, or none, and no packet goes on behind them: a datagram, the end of a
            // connection
    nothing,
    end,
  };
  virtual ~PacketSource() = default;

  /// Puts what came in the place of what `bytes` held. Waits a tenth of a second at most. Throws
  /// std::runtime_error when the source fails.
  virtual Got read(std::vector<std::uint8_t>& bytes) = 0;
  /// Whether packets come when they are sent, and have no end.
  virtual bool is_live() const = 0;
  /// The share that was read, in [0, 1]; 0 where there is no end.
  virtual double progress() const { return 0; }
};

/// "-" is standard input. All throw std::runtime_error with what would mend it.
std::unique_ptr<PacketSource> file_source(const std::filesystem::path& file);
/// Datagrams to a port of 127.0.0.1, each of whole packets.
std::unique_ptr<PacketSource> udp_source(std::uint16_t port);
/// A stream to a port of 127.0.0.1, of one sender at a time; when it ends the next one may come.
std::unique_ptr<PacketSource> tcp_source(std::uint16_t port);

}  // namespace reident::satcs
