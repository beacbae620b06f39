#include "service/satcs/gateway/packet_counts.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/support/log.hpp"

namespace reident::satcs {
namespace {

constexpr std::uint64_t told_at_once = 3;  // of each kind; the summary has the rest

std::string meaning(const std::string& reason) {
  if (reason == "no_header") return "bytes that begin no packet";
  if (reason == "cut") return "a packet that is not complete";
  if (reason == "command") return "telecommands";
  if (reason == "segment") return "segments of longer packets, which are not put together";
  if (reason == "no_container") return "packets that no container is for";
  if (reason == "too_short") return "packets that end before their container";
  if (reason == "no_time") return "packets without a time that can be read";
  return "packets with a time before 1990 or after tomorrow (--force-times takes them)";
}

}  // namespace

std::uint64_t PacketCounts::add(const PacketHeader& header, std::uint64_t offset) {
  Apid& apid = apids_[header.apid];
  ++apid.packets;
  const auto last = std::exchange(apid.last, header.count);
  if (!last || header.apid == idle_apid) return 0;
  const unsigned ahead = (header.count - *last) & (sequence_counts - 1U);
  if (ahead == 1) return 0;
  if (ahead == 0) return ++apid.repeated, 0;
  if (ahead > sequence_counts / 2) return ++apid.out_of_order, 0;
  const std::uint64_t missing = ahead - 1;
  if (apid.missing < told_at_once)
    log::warning("gateway", "packets are missing by their sequence counts",
                 {{"apid", header.apid}, {"missing", missing}, {"before_byte", offset}});
  apid.missing += missing;
  return missing;
}

void PacketCounts::leave_out(const std::string& reason, std::uint64_t offset, std::size_t bytes,
                             const std::string& detail) {
  LeftOut& one = left_out_[reason];
  if (one.count == 0) {
    one.first_offset = offset;
    one.first = detail;
  }
  if (++one.count <= told_at_once)
    log::warning("gateway", "left out", {{"reason", reason}, {"byte", offset}, {"detail", detail}});
  one.bytes += bytes;
}

void PacketCounts::add_rest(const std::string& container, std::uint64_t bits) {
  Rest& rest = rests_[container];
  ++rest.packets;
  rest.bits = std::max(rest.bits, bits);
}

std::uint64_t PacketCounts::missing() const {
  std::uint64_t sum = 0;
  for (const auto& [apid, counts] : apids_) sum += counts.missing;
  return sum;
}

std::vector<std::string> PacketCounts::sentences() const {
  std::vector<std::string> sentences;
  for (const auto& [apid, counts] : apids_) {
    std::string text = fmt::format("APID {}: {} packets", apid, counts.packets);
    if (apid == idle_apid) text += ", idle";
    if (counts.missing > 0) text += fmt::format(", {} missing", counts.missing);
    if (counts.repeated > 0) text += fmt::format(", {} repeated", counts.repeated);
    if (counts.out_of_order > 0) text += fmt::format(", {} out of order", counts.out_of_order);
    sentences.push_back(text);
  }
  for (const auto& [reason, one] : left_out_)
    sentences.push_back(fmt::format("left out, {}: {} times, {} ({} bytes), the first at byte {}{}",
                                    reason, one.count, meaning(reason), one.bytes, one.first_offset,
                                    one.first.empty() ? "" : ": " + one.first));
  for (const auto& [container, rest] : rests_)
    sentences.push_back(fmt::format("container {}: {} packets go on behind it, by {} bits at most",
                                    container, rest.packets, rest.bits));
  return sentences;
}

std::string PacketCounts::json() const {
  nlohmann::ordered_json json;
  auto& object = json["packets"];
  object["apids"] = nlohmann::ordered_json::array();
  for (const auto& [apid, counts] : apids_)
    object["apids"].push_back({{"apid", apid},
                               {"packets", counts.packets},
                               {"missing", counts.missing},
                               {"repeated", counts.repeated},
                               {"out_of_order", counts.out_of_order}});
  object["left_out"] = nlohmann::ordered_json::array();
  for (const auto& [reason, one] : left_out_)
    object["left_out"].push_back({{"reason", reason},
                                  {"count", one.count},
                                  {"bytes", one.bytes},
                                  {"first_offset", one.first_offset},
                                  {"first", one.first}});
  object["longer_than_container"] = nlohmann::ordered_json::array();
  for (const auto& [container, rest] : rests_)
    object["longer_than_container"].push_back(
        {{"container", container}, {"packets", rest.packets}, {"bits", rest.bits}});
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace reident::satcs
