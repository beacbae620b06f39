// The time of a packet, from a CCSDS time code (301.0-B) in its secondary header.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// Which time code stands where in a packet.
struct TimeCode {
  enum class Kind {
    cuc,      // unsegmented: `coarse` bytes of seconds, `fine` bytes of their fraction
    cds,      // segmented: `coarse` bytes of days, ms of the day, `fine` bytes of the ms: 2 are us,
              // 4 are ps
    p_field,  // either; its first bytes say which (the P-field)
    reception,  // none: when the packet was received
  };
  Kind kind = Kind::cuc;
  std::size_t coarse = 4;
  std::size_t fine = 2;
  std::size_t offset = 6;  // bytes from the packet's begin

  /// UTC of count 0; absent: 1958-01-01 TAI, whose seconds count on through leap seconds.
  std::optional<storage::Time> epoch = {};
  /// Seconds since an `epoch` of its own count on through leap seconds too.
  bool counts_leap_seconds = false;
};

/// "cuc:4.2", "cds", "cds:2.2", "pfield" or "reception", each but the last also with "@OFFSET".
std::optional<TimeCode> parse_time_code(std::string_view text);
inline constexpr std::string_view time_code_form =
    "cuc:C.F (bytes of seconds and of their fraction), cds or cds:D.S (bytes of days and of the "
    "millisecond), pfield or reception, with @OFFSET where it does not begin at byte 6";

/// UTC of the packet; absent where the packet is too short, the code is not one, or its time is
/// outside of what a Time holds. `code` is not `reception`.
std::optional<storage::Time> packet_time(std::span<const std::uint8_t> packet, TimeCode code);

}  // namespace reident::satcs
