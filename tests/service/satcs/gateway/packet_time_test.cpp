#include "service/satcs/gateway/packet_time.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "service/support/time_text.hpp"

namespace reident::test::packet_time_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::string time_of(const std::string& code, const Bytes& field, const char* epoch = nullptr,
                    bool counts_leap_seconds = false) {
  auto parsed = satcs::parse_time_code(code);
  if (!parsed) return "no code";
  if (epoch != nullptr) parsed->epoch = parse_time(epoch);
  parsed->counts_leap_seconds = counts_leap_seconds;
  Bytes packet(6);
  packet.insert(packet.end(), field.begin(), field.end());
  const auto time = satcs::packet_time(packet, *parsed);
  return time ? time_text(*time) : "none";
}

/// Big-endian.
Bytes bytes(std::uint64_t value, int count) {
  Bytes result;
  for (int i = count - 1; i >= 0; --i)
    result.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  return result;
}

Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

// 2024-02-29T00:00:00Z is 24165 days after 1958, and TAI 37 s ahead.
constexpr std::uint64_t leap_day = 24'165, leap_day_tai = leap_day * 86'400 + 37;

TEST(PacketTime, OfCucCountsTaiSince1958) {
  EXPECT_EQ(time_of("cuc:4.0", bytes(leap_day_tai, 4)), "2024-02-29T00:00:00Z");
  EXPECT_EQ(time_of("cuc:4.2", bytes(leap_day_tai, 4) + bytes(0x8000, 2)),
            "2024-02-29T00:00:00.5Z");
  EXPECT_EQ(time_of("cuc:4.1@7", bytes(9, 1) + bytes(leap_day_tai, 4) + bytes(0x40, 1)),
            "2024-02-29T00:00:00.25Z");
  EXPECT_EQ(time_of("cuc:5.3", bytes(leap_day_tai, 5) + bytes(1 << 22, 3)),
            "2024-02-29T00:00:00.25Z");
  // The leap second at the end of 2016: 23:59:60 has the time of the second behind it.
  constexpr std::uint64_t end_of_2016 = 21'550 * std::uint64_t{86'400} + 36;
  EXPECT_EQ(time_of("cuc:4.0", bytes(end_of_2016 - 1, 4)), "2016-12-31T23:59:59Z");
  EXPECT_EQ(time_of("cuc:4.0", bytes(end_of_2016 + 1, 4)), "2017-01-01T00:00:00Z");
}

TEST(PacketTime, OfCucCountsFromAnEpochOfItsOwn) {
  EXPECT_EQ(time_of("cuc:4.0", bytes(86'400, 4), "2016-12-31T00:00:00Z"), "2017-01-01T00:00:00Z");
  EXPECT_EQ(time_of("cuc:4.0", bytes(86'401, 4), "2016-12-31T00:00:00Z", true),
            "2017-01-01T00:00:00Z");
}

TEST(PacketTime, OfCdsCountsDaysAndMilliseconds) {
  const Bytes day = bytes(leap_day, 2) + bytes(43'200'123, 4);
  EXPECT_EQ(time_of("cds", day), "2024-02-29T12:00:00.123Z");
  EXPECT_EQ(time_of("cds:2.2", day + bytes(456, 2)), "2024-02-29T12:00:00.123456Z");
  EXPECT_EQ(time_of("cds:2.4", day + bytes(456'789'000, 4)), "2024-02-29T12:00:00.123456789Z");
  EXPECT_EQ(time_of("cds:3.0", bytes(leap_day, 3) + bytes(0, 4)), "2024-02-29T00:00:00Z");
  EXPECT_EQ(time_of("cds", bytes(59, 2) + bytes(0, 4), "2024-01-01T00:00:00Z"),
            "2024-02-29T00:00:00Z");
  EXPECT_EQ(time_of("cds", bytes(leap_day, 2) + bytes(86'402'000, 4)), "none");
}

TEST(PacketTime, IsSaidByThePField) {
  EXPECT_EQ(time_of("pfield", bytes(0x1e, 1) + bytes(leap_day_tai, 4) + bytes(0x8000, 2)),
            "2024-02-29T00:00:00.5Z");
  EXPECT_EQ(time_of("pfield", bytes(0x2c, 1) + bytes(60, 4)), "none") << "an epoch is not known";
  EXPECT_EQ(time_of("pfield", bytes(0x2c, 1) + bytes(60, 4), "2024-02-29T00:00:00Z"),
            "2024-02-29T00:01:00Z");
  EXPECT_EQ(time_of("pfield", bytes(0x40, 1) + bytes(leap_day, 2) + bytes(1000, 4)),
            "2024-02-29T00:00:01Z");
  EXPECT_EQ(time_of("pfield", bytes(0x45, 1) + bytes(leap_day, 3) + bytes(1000, 4) + bytes(7, 2)),
            "2024-02-29T00:00:01.000007Z");
  EXPECT_EQ(time_of("pfield", bytes(0x9c20, 2) + bytes(leap_day_tai, 5)), "2024-02-29T00:00:00Z");
  EXPECT_EQ(time_of("pfield", bytes(0x70, 1) + bytes(0, 8)), "none");
}

TEST(PacketTime, IsMissingWhereThePacketEnds) {
  EXPECT_EQ(time_of("cuc:4.2", bytes(0, 5)), "none");
  EXPECT_EQ(time_of("cds:2.4", bytes(0, 9)), "none");
  EXPECT_EQ(time_of("pfield", {}), "none");
  EXPECT_EQ(time_of("cuc:4.2@60000", bytes(0, 6)), "none");
}

TEST(PacketTime, IsAskedForInOneForm) {
  for (const char* text : {"cuc", "cuc:", "cuc:0.2", "cuc:8.0", "cuc:4.8", "cuc:42", "cds:4.0",
                           "cds:2.3", "cuc:4.2@", "cuc:4.2@x", "cuc:4.2@70000", "p", "", "tai"})
    EXPECT_FALSE(satcs::parse_time_code(text)) << text;
  EXPECT_EQ(satcs::parse_time_code("reception")->kind, satcs::TimeCode::Kind::reception);
  EXPECT_EQ(satcs::parse_time_code("cds:3.4@10")->offset, 10U);
}

}  // namespace
}  // namespace reident::test::packet_time_test
