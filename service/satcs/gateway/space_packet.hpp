// CCSDS space packets (133.0-B): the primary header, and packets out of a stream of bytes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace reident::satcs {

inline constexpr std::size_t primary_header_bytes = 6;
inline constexpr std::uint16_t idle_apid = 0x7ff;
inline constexpr std::uint16_t sequence_counts = 1U << 14;  // the count wraps there

struct PacketHeader {
  std::uint8_t version = 0;  // 0 is the only one
  bool is_command = false;
  std::uint16_t apid = 0;
  bool is_whole = true;  // false: a segment of a longer one
  std::uint16_t count = 0;
  std::size_t bytes = 0;  // of the packet, this header included
};
/// The first six bytes, which have to be there.
PacketHeader packet_header(std::span<const std::uint8_t> bytes);

/// Cuts a stream of bytes into packets. Where no packet begins, it looks for the next place at
/// which one does and another one follows. One thread at a time.
class PacketSplitter {
 public:
  /// What was left out: bytes of the stream from `offset` on, and why.
  using LeftOut = std::function<void(const char* reason, std::uint64_t offset, std::size_t bytes)>;

  /// `prefix_bytes` stand before each packet and are skipped.
  PacketSplitter(std::size_t prefix_bytes, LeftOut left_out);

  void add(std::span<const std::uint8_t> bytes);
  /// Nothing follows what was added: a packet that is not complete is left out.
  void end();
  /// The next packet, with its prefix cut off, good until the next call of any function; empty
  /// where more bytes are needed.
  std::span<const std::uint8_t> next();
  /// Where the packet that came last began in the stream, behind its prefix.
  std::uint64_t offset() const { return offset_; }

 private:
  bool begins_at(std::size_t at) const;
  /// Bytes to the next place where a packet begins; absent where more are needed to know.
  std::optional<std::size_t> to_next_begin() const;
  void leave_out(const char* reason, std::size_t bytes);

  std::size_t prefix_;
  LeftOut left_out_;
  std::vector<std::uint8_t> buffer_;
  std::size_t read_ = 0;        // of the buffer
  std::uint64_t consumed_ = 0;  // of the stream before the buffer's begin
  std::uint64_t offset_ = 0;
  bool at_end_ = false;
};

}  // namespace reident::satcs
