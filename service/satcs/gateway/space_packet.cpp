#include "service/satcs/gateway/space_packet.hpp"

#include <utility>

namespace reident::satcs {

PacketHeader packet_header(std::span<const std::uint8_t> bytes) {
  const auto word = [&](std::size_t at) {
    return static_cast<std::uint16_t>((bytes[at] << 8) | bytes[at + 1]);
  };
  PacketHeader header;
  header.version = static_cast<std::uint8_t>(bytes[0] >> 5);
  header.is_command = (bytes[0] & 0x10U) != 0;
  header.apid = static_cast<std::uint16_t>(word(0) & 0x7ffU);
  header.is_whole = (bytes[2] >> 6) == 3;
  header.count = static_cast<std::uint16_t>(word(2) & (sequence_counts - 1));
  header.bytes = primary_header_bytes + 1 + word(4);
  return header;
}

PacketSplitter::PacketSplitter(std::size_t prefix_bytes, LeftOut left_out)
    : prefix_(prefix_bytes), left_out_(std::move(left_out)) {}

void PacketSplitter::add(std::span<const std::uint8_t> bytes) {
  consumed_ += read_;
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(read_));
  read_ = 0;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
  at_end_ = false;
}

void PacketSplitter::end() {
  at_end_ = true;
}

void PacketSplitter::leave_out(const char* reason, std::size_t bytes) {
  left_out_(reason, consumed_ + read_, bytes);
  read_ += bytes;
}

bool PacketSplitter::begins_at(std::size_t at) const {
  return packet_header(std::span(buffer_).subspan(at, primary_header_bytes)).version == 0;
}

std::optional<std::size_t> PacketSplitter::to_next_begin() const {
  const std::size_t header = prefix_ + primary_header_bytes;
  for (std::size_t at = read_ + 1; at + header <= buffer_.size(); ++at) {
    const PacketHeader found =
        packet_header(std::span(buffer_).subspan(at + prefix_, primary_header_bytes));
    if (found.version != 0 || found.is_command) continue;
    const std::size_t next = at + prefix_ + found.bytes;
    if (next == buffer_.size() && at_end_) return at - read_;
    if (next + header <= buffer_.size()) {
      if (begins_at(next + prefix_)) return at - read_;
    } else if (!at_end_) {
      return std::nullopt;
    }
  }
  return at_end_ ? std::optional(buffer_.size() - read_) : std::nullopt;
}

std::span<const std::uint8_t> PacketSplitter::next() {
  while (true) {
    const std::size_t there = buffer_.size() - read_;
    if (there < prefix_ + primary_header_bytes) {
      if (at_end_ && there > 0) leave_out("cut", there);
      return {};
    }
    if (!begins_at(read_ + prefix_)) {
      const auto skipped = to_next_begin();
      if (!skipped) return {};
      leave_out("no_header", *skipped);
      continue;
    }
    const auto packet = std::span<const std::uint8_t>(buffer_).subspan(read_ + prefix_);
    const std::size_t bytes = packet_header(packet).bytes;
    if (packet.size() < bytes) {
      if (at_end_) leave_out("cut", there);
      return {};
    }
    offset_ = consumed_ + read_ + prefix_;
    read_ += prefix_ + bytes;
    return packet.first(bytes);
  }
}

}  // namespace reident::satcs
