#include "service/satcs/gateway/packet_time.hpp"

#include <charconv>
#include <cmath>

#include "service/telemetry_file/time_zone.hpp"

namespace reident::satcs {
namespace {

using storage::Time;

constexpr std::size_t most_bytes = 7;
constexpr Time day_ns = 86'400 * storage::second_ns;
constexpr Time epoch_1958 = -4'383 * day_ns;
constexpr Time tai_at_gps_epoch = 8'040 * day_ns + 19 * storage::second_ns;  // since 1958-01-01 TAI

std::uint64_t number(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

/// Returns GPS seconds, which count on through leap seconds.
Time gps_of_utc(Time utc) {
  Time gps = utc - 3'657 * day_ns;
  for (int i = 0; i < 2; ++i) gps += utc - telemetry_file::utc_of_gps(gps);
  return gps;
}

std::optional<Time> sum(Time a, Time b) {
  Time total = 0;
  if (__builtin_add_overflow(a, b, &total)) return std::nullopt;
  return total;
}

std::optional<Time> since_epoch(const TimeCode& code, Time elapsed) {
  if (!code.epoch) return telemetry_file::utc_of_gps(elapsed - tai_at_gps_epoch);
  if (!code.counts_leap_seconds) return sum(*code.epoch, elapsed);
  const auto gps = sum(gps_of_utc(*code.epoch), elapsed);
  return gps ? std::optional(telemetry_file::utc_of_gps(*gps)) : std::nullopt;
}

std::optional<Time> of_cuc(std::span<const std::uint8_t> field, const TimeCode& code) {
  const std::uint64_t seconds = number(field.first(code.coarse));
  constexpr std::uint64_t most = 8'000'000'000;  // some 253 years
  if (seconds > most) return std::nullopt;
  const double fraction = std::ldexp(static_cast<double>(number(field.subspan(code.coarse))),
                                     -8 * static_cast<int>(code.fine));
  const auto nanoseconds =
      static_cast<Time>(std::llround(fraction * static_cast<double>(storage::second_ns)));
  return since_epoch(code, static_cast<Time>(seconds) * storage::second_ns + nanoseconds);
}

// Days are of UTC: no leap second is among them.
std::optional<Time> of_cds(std::span<const std::uint8_t> field, const TimeCode& code) {
  const std::uint64_t days = number(field.first(code.coarse));
  const std::uint64_t milliseconds = number(field.subspan(code.coarse, 4));
  const std::uint64_t part = number(field.subspan(code.coarse + 4));
  constexpr std::uint64_t most_days = 90'000, day_ms = 86'401'000;
  if (days > most_days || milliseconds >= day_ms) return std::nullopt;
  const std::uint64_t part_ns = code.fine == 4 ? part / 1000 : part * 1000;
  return sum(
      code.epoch.value_or(epoch_1958),
      static_cast<Time>(days) * day_ns + static_cast<Time>(milliseconds * 1'000'000 + part_ns));
}

/// What a P-field says, with the offset behind it.
std::optional<TimeCode> of_p_field(std::span<const std::uint8_t> packet, TimeCode code) {
  if (packet.size() <= code.offset + 1) return std::nullopt;
  const std::uint8_t first = packet[code.offset];
  const auto bits = [](unsigned byte, unsigned shift, unsigned count) {
    return std::size_t{(byte >> shift) & ((1U << count) - 1)};
  };
  const bool goes_on = (first & 0x80U) != 0;
  const std::size_t identifier = bits(first, 4, 3);
  const bool is_cuc = identifier == 1 || identifier == 2;
  const bool has_own_epoch = identifier == 2 || (identifier == 4 && bits(first, 3, 1) == 1);
  if ((!is_cuc && identifier != 4) || (has_own_epoch && !code.epoch)) return std::nullopt;
  if (!has_own_epoch) code.epoch.reset();
  code.offset += goes_on ? 2 : 1;
  if (is_cuc) {
    const std::uint8_t second = goes_on ? packet[code.offset - 1] : std::uint8_t{0};
    code.kind = TimeCode::Kind::cuc;
    code.coarse = bits(first, 2, 2) + 1 + bits(second, 5, 2);
    code.fine = bits(first, 0, 2) + bits(second, 2, 3);
    return code;
  }
  code.kind = TimeCode::Kind::cds;
  code.coarse = bits(first, 2, 1) == 1 ? 3 : 2;
  code.fine = 2 * bits(first, 0, 2);
  return code.fine <= 4 ? std::optional(code) : std::nullopt;
}

/// "C.F"; false where it is anything else.
bool parse_sizes(std::string_view text, TimeCode& code) {
  const auto dot = text.find('.');
  if (dot != 1 || text.size() != 3) return false;
  const char coarse = text[0], fine = text[2];
  if (coarse < '0' || coarse > '9' || fine < '0' || fine > '9') return false;
  code.coarse = static_cast<std::size_t>(coarse - '0');
  code.fine = static_cast<std::size_t>(fine - '0');
  if (code.kind == TimeCode::Kind::cuc)
    return code.coarse >= 1 && code.coarse <= most_bytes && code.fine <= most_bytes;
  return (code.coarse == 2 || code.coarse == 3) &&
         (code.fine == 0 || code.fine == 2 || code.fine == 4);
}

}  // namespace

std::optional<TimeCode> parse_time_code(std::string_view text) {
  TimeCode code;
  if (const auto at = text.find('@'); at != std::string_view::npos) {
    const std::string_view offset = text.substr(at + 1);
    const auto [end, error] =
        std::from_chars(offset.data(), offset.data() + offset.size(), code.offset);
    if (error != std::errc() || end != offset.data() + offset.size() || code.offset > 65'000)
      return std::nullopt;
    text = text.substr(0, at);
  } else if (text == "reception") {
    code.kind = TimeCode::Kind::reception;
    return code;
  }
  if (text == "pfield") {
    code.kind = TimeCode::Kind::p_field;
    return code;
  }
  if (text.starts_with("cds")) {
    code.kind = TimeCode::Kind::cds;
    code.coarse = 2;
    code.fine = 0;
    if (text == "cds") return code;
  }
  if (!text.starts_with("cuc:") && !text.starts_with("cds:")) return std::nullopt;
  return parse_sizes(text.substr(4), code) ? std::optional(code) : std::nullopt;
}

std::optional<Time> packet_time(std::span<const std::uint8_t> packet, TimeCode code) {
  if (code.kind == TimeCode::Kind::p_field) {
    const auto said = of_p_field(packet, code);
    if (!said) return std::nullopt;
    code = *said;
  }
  const std::size_t bytes = code.coarse + code.fine + (code.kind == TimeCode::Kind::cds ? 4 : 0);
  if (code.offset > packet.size() || packet.size() - code.offset < bytes) return std::nullopt;
  const auto field = packet.subspan(code.offset, bytes);
  return code.kind == TimeCode::Kind::cds ? of_cds(field, code) : of_cuc(field, code);
}

}  // namespace reident::satcs
