// The topics of a pair of services: whose leadership is heard, and rows on their way.
#include <gmock/gmock.h>

#include "service/dds/codec.hpp"
#include "tests/service/dds/dds_fixture.hpp"

namespace reident::test::pair_topics_test {
namespace {

Leadership leadership(std::int64_t term, const std::string& service) {
  return {"reident", term, service, 7, {}};
}

dds::Writer<Leadership> writer_of(dds::Participant& participant, std::int64_t term) {
  dds::WriterOptions options;
  options.strength = static_cast<std::int32_t>(term);
  return dds::Writer<Leadership>(participant, options);
}

TEST(LeadershipTopic, OfTwoThatLeadTheLaterTermIsHeardAlsoByTheOther) {
  dds::Participant one(own_endpoint()), other(own_endpoint());
  auto earlier = writer_of(one, 2);
  dds::Reader<Leadership> reader(one);  // hears its own side too
  earlier.write(leadership(2, "reident-2"));
  EXPECT_EQ(take_all(reader, 1).at(0).service, "reident-2");
  auto later = writer_of(other, 3);
  ASSERT_TRUE(eventually([&] { return reader.matched_writers() == 2; }));
  later.write(leadership(3, "reident-1"));
  const Leadership heard = take_all(reader, 1).at(0);
  EXPECT_EQ(heard.term, 3);
  EXPECT_EQ(heard.service, "reident-1");
  earlier.write(leadership(2, "reident-2"));
  later.write(leadership(3, "reident-1"));
  EXPECT_EQ(take_all(reader, 1).at(0).term, 3) << "the weaker one is not heard";
}

TEST(LeadershipTopic, OneThatSaysNothingForTheLeaseHasEnded) {
  dds::Participant leader(own_endpoint()), follower(own_endpoint());
  auto writer = writer_of(leader, 2);
  dds::Reader<Leadership> reader(follower);
  writer.write(leadership(2, "reident-2"));
  EXPECT_EQ(take_all(reader, 1).at(0).position, 7);
  const auto begin = std::chrono::steady_clock::now();
  bool has_ended = false;
  ASSERT_TRUE(eventually([&] {
    reader.take(
        8, [](Leadership&&) {}, {},
        [&](Leadership&& ended) { has_ended = ended.pair == "reident"; });
    return has_ended;
  }));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 2 * dds::leadership_lease);
  writer.write(leadership(2, "reident-2"));
  EXPECT_EQ(take_all(reader, 1).at(0).term, 2) << "heard again when it goes on";
}

TEST(ReplicaTopic, RowsAndTermsArriveAsTheyWereSent) {
  dds::Participant participant(own_endpoint());
  dds::Writer<Replica> writer(participant);
  dds::Reader<Replica> reader(participant);
  Replica sent;
  sent.sender = "reident-2";
  sent.pair = "reident";
  sent.receiver = "reident-1";
  sent.kind = Replica::Kind::given_up;
  sent.terms = {{2, "reident-2", 5, 1}, {3, "reident-1", 6, 90}};
  sent.part = {12, 14, {0, 255, 7}};
  writer.write(sent);
  const Replica heard = take_all(reader, 1).at(0);
  EXPECT_EQ(heard.sender, sent.sender);
  EXPECT_EQ(heard.receiver, sent.receiver);
  EXPECT_EQ(heard.kind, sent.kind);
  EXPECT_EQ(heard.terms, sent.terms);
  EXPECT_EQ(heard.part.after, 12);
  EXPECT_EQ(heard.part.last, 14);
  EXPECT_EQ(heard.part.rows, sent.part.rows);
}

TEST(ReplicaTopic, AMessageOfAnUnknownKindIsRefused) {
  dds::Codec<Replica>::Encoder encode;
  Replica message;
  message.sender = message.pair = "reident";
  reident_Replica wire = encode(message);
  Replica read;
  EXPECT_EQ(dds::Codec<Replica>::decode(wire, {}, read), std::nullopt);
  wire.kind = 9;
  EXPECT_THAT(dds::Codec<Replica>::decode(wire, {}, read).value_or(""),
              testing::HasSubstr("kind 9"));
  wire.kind = 0;
  wire.after = 5;
  EXPECT_THAT(dds::Codec<Replica>::decode(wire, {}, read).value_or(""),
              testing::HasSubstr("positions"));
}

}  // namespace
}  // namespace reident::test::pair_topics_test
