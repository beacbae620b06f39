#include "service/satcs/gateway/space_packet.hpp"

#include <gmock/gmock.h>

#include "tests/service/satcs/gateway/xtce_text.hpp"

namespace reident::test::space_packet_test {
namespace {

using satcs::PacketSplitter;
using testing::ElementsAre;
using testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

/// What a splitter makes of a stream that comes in pieces of one size.
struct Split {
  Split(const Bytes& stream, std::size_t piece, std::size_t prefix = 0) {
    PacketSplitter splitter(
        prefix, [&](const char* reason, std::uint64_t offset, std::size_t bytes) {
          left_out.push_back(std::string(reason) + " at " + std::to_string(offset) + ": " +
                             std::to_string(bytes));
        });
    const auto take = [&] {
      for (auto one = splitter.next(); !one.empty(); one = splitter.next()) {
        packets.emplace_back(one.begin(), one.end());
        offsets.push_back(splitter.offset());
      }
    };
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      splitter.add(std::span(stream).subspan(at, std::min(piece, stream.size() - at)));
      take();
    }
    splitter.end();
    take();
  }
  std::vector<Bytes> packets;
  std::vector<std::uint64_t> offsets;
  std::vector<std::string> left_out;
};

void append(Bytes& stream, const Bytes& more) {
  stream.insert(stream.end(), more.begin(), more.end());
}

const Bytes one = packet_of({1, 2, 3}, 1), two = packet_of({4}, 2),
            three = packet_of(Bytes(300, 5), 3);

TEST(SpacePacket, HasItsPrimaryHeader) {
  const auto header = satcs::packet_header(packet_of(Bytes(300, 0), 0x1234, 0x5a5));
  EXPECT_EQ(header.version, 0);
  EXPECT_FALSE(header.is_command);
  EXPECT_EQ(header.apid, 0x5a5);
  EXPECT_TRUE(header.is_whole);
  EXPECT_EQ(header.count, 0x1234);
  EXPECT_EQ(header.bytes, 306U);
}

TEST(SpacePacket, ComesOutOfAStreamHoweverItIsCut) {
  Bytes stream;
  for (const Bytes& packet : {one, two, three}) append(stream, packet);
  for (const std::size_t piece : {1U, 2U, 5U, 7U, 100U, 1000U}) {
    const Split split(stream, piece);
    EXPECT_THAT(split.packets, ElementsAre(one, two, three));
    EXPECT_THAT(split.offsets, ElementsAre(0, 9, 16));
    EXPECT_THAT(split.left_out, IsEmpty());
  }
}

TEST(SpacePacket, IsFoundAgainBehindBytesThatAreNone) {
  Bytes stream = one;
  append(stream, Bytes(50, 0xff));
  append(stream, two);
  append(stream, three);
  for (const std::size_t piece : {1U, 13U, 1000U}) {
    const Split split(stream, piece);
    EXPECT_THAT(split.packets, ElementsAre(one, two, three));
    EXPECT_THAT(split.left_out, ElementsAre("no_header at 9: 50"));
  }
}

TEST(SpacePacket, IsCountedWhereItIsCut) {
  Bytes stream = one;
  append(stream, three);
  stream.resize(stream.size() - 1);
  EXPECT_THAT(Split(stream, 64).left_out, ElementsAre("cut at 9: 305"));
  stream.resize(12);
  EXPECT_THAT(Split(stream, 64).left_out, ElementsAre("cut at 9: 3"));
  EXPECT_THAT(Split(Bytes(40, 0xff), 64).left_out, ElementsAre("no_header at 0: 40"));
}

TEST(SpacePacket, StandsBehindAPrefix) {
  Bytes stream;
  for (const Bytes& packet : {one, two}) {
    append(stream, {0xff, 0xff, 0xff, 0xff});
    append(stream, packet);
  }
  const Split split(stream, 3, 4);
  EXPECT_THAT(split.packets, ElementsAre(one, two));
  EXPECT_THAT(split.offsets, ElementsAre(4, 17));
}

}  // namespace
}  // namespace reident::test::space_packet_test
