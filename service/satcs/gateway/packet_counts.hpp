// What came of the packets of a source, counted by APID and by what was wrong.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "service/satcs/gateway/space_packet.hpp"

namespace reident::satcs {

class PacketCounts {
 public:
  /// Packets of one APID. The sequence counts of its packets have 14 bits: more than 8191 packets
  /// that are missing in a row look like others.
  struct Apid {
    std::uint64_t packets = 0;
    std::uint64_t missing = 0;
    std::uint64_t repeated = 0;      // the same count as the one before
    std::uint64_t out_of_order = 0;  // a count before that of the one before, as after a restart
    std::optional<std::uint16_t> last = {};
  };
  /// What was left out for one reason.
  struct LeftOut {
    std::uint64_t count = 0;  // packets; of "no_header" and "cut" stretches of bytes
    std::uint64_t bytes = 0;
    std::uint64_t first_offset = 0;  // in the stream
    std::string first;               // what was wrong there
  };

  /// Counts a packet; returns how many of its APID are missing before it.
  std::uint64_t add(const PacketHeader& header, std::uint64_t offset);
  void leave_out(const std::string& reason, std::uint64_t offset, std::size_t bytes,
                 const std::string& detail);
  /// Bits behind the last entry of a container.
  void add_rest(const std::string& container, std::uint64_t bits);

  std::uint64_t missing() const;
  /// For people: what is missing and what was left out, a sentence each.
  std::vector<std::string> sentences() const;
  /// {"packets": {"apids": [...], "left_out": [...], "longer_than_container": [...]}}
  std::string json() const;

 private:
  std::map<std::uint16_t, Apid> apids_;
  std::map<std::string, LeftOut> left_out_;  // by reason
  struct Rest {
    std::uint64_t packets = 0;
    std::uint64_t bits = 0;  // the most
  };
  std::map<std::string, Rest> rests_;  // by container
};

}  // namespace reident::satcs
