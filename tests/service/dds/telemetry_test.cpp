#include <gmock/gmock.h>

#include "service/dds/codec.hpp"
#include "service/dds/domain.hpp"
#include "service/dds/qos.hpp"
#include "tests/service/dds/dds_fixture.hpp"

namespace reident::test::telemetry_test {
namespace {

using storage::TelemetryFrame;

TEST(Telemetry, ArrivesAsItWasSent) {
  dds::Participant participant(own_endpoint());
  dds::Reader<TelemetryFrame> reader(participant);
  dds::Writer<TelemetryFrame> writer(participant);
  TelemetryFrame sent = make_frame(7);
  sent.origin = storage::Origin::simulated;
  sent.samples[1].quality = storage::Quality::suspect;
  sent.samples[2].value = -0.0;
  sent.first_sequence = 5;
  writer.write(sent);

  const auto received = take_all(reader, 1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].spacecraft, "CBERS4");
  EXPECT_EQ(received[0].source, "station");
  EXPECT_EQ(received[0].origin, storage::Origin::simulated);
  EXPECT_EQ(received[0].sequence, 7U);
  EXPECT_EQ(received[0].first_sequence, 5U);
  EXPECT_EQ(received[0].generation_time, sent.generation_time);
  EXPECT_EQ(received[0].reception_time, sent.reception_time);
  ASSERT_EQ(received[0].samples.size(), 3U);
  EXPECT_EQ(received[0].samples[1].quality, storage::Quality::suspect);
  EXPECT_TRUE(std::signbit(received[0].samples[2].value));
}

TEST(Telemetry, AReaderThatKeepsTheNewestAloneIsNoArchive) {
  dds::Participant ground(own_endpoint());
  dds::Participant others(own_endpoint());
  dds::Writer<TelemetryFrame> writer(ground);
  EXPECT_EQ(writer.matched_archives(), 0U);
  const dds::Reader<TelemetryFrame> simulator(others, {.keep_last = 16});
  ASSERT_TRUE(eventually([&] { return writer.matched_readers() == 1; }));
  EXPECT_EQ(writer.matched_archives(), 0U);
  {
    const dds::Reader<TelemetryFrame> archive(others);
    ASSERT_TRUE(eventually([&] { return writer.matched_archives() == 1; }));
  }
  EXPECT_TRUE(eventually([&] { return writer.matched_archives() == 0; }));
  EXPECT_EQ(writer.matched_readers(), 1U);
}

TEST(Telemetry, ASenderKnowsWhatAReceiverWouldRefuse) {
  TelemetryFrame frame = make_frame(1);
  EXPECT_EQ(dds::refusal(frame), std::nullopt);
  frame.source = "Rio de Janeiro \xe3";
  EXPECT_EQ(dds::refusal(frame), "source is not UTF-8");
  storage::ParameterDescriptor descriptor;
  descriptor.spacecraft = "SAT";
  descriptor.name = "V";
  EXPECT_EQ(dds::refusal(descriptor), std::nullopt);
  descriptor.unit =
      "\xb0"
      "C";
  EXPECT_EQ(dds::refusal(descriptor), "unit is not UTF-8");
}

TEST(Telemetry, ALateReaderGetsTheHistoryThatTheWriterKeeps) {
  dds::Participant ground(own_endpoint());
  dds::Participant service(own_endpoint());
  dds::Writer<TelemetryFrame> writer(ground, {.history = 5});
  for (std::uint64_t i = 1; i <= 8; ++i) writer.write(make_frame(i));
  dds::Reader<TelemetryFrame> reader(service);
  EXPECT_THAT(sequences(take_all(reader, 5)), testing::ElementsAre(4, 5, 6, 7, 8));
}

TEST(Telemetry, AWriterWithoutHistoryIsHeardBesideOneWithHistory) {
  dds::Participant ground(own_endpoint());
  dds::Participant service(own_endpoint());
  dds::Writer<TelemetryFrame> keeps(ground, {.history = 3});
  dds::Writer<TelemetryFrame> keeps_nothing(ground, {.history = 0});
  for (std::uint64_t i = 1; i <= 3; ++i) keeps.write(make_frame(i));
  dds::Reader<TelemetryFrame> reader(service);
  ASSERT_TRUE(eventually([&] { return reader.matched_writers() == 2; }));
  ASSERT_TRUE(eventually([&] { return keeps_nothing.matched_readers() == 1; }));
  for (std::uint64_t i = 4; i <= 6; ++i) keeps.write(make_frame(i));
  TelemetryFrame other = make_frame(100);
  other.source = "other station";
  keeps_nothing.write(other);

  const auto received = sequences(take_all(reader, 7));
  EXPECT_THAT(received, testing::UnorderedElementsAre(1, 2, 3, 4, 5, 6, 100));
  EXPECT_EQ(reader.take(100, [](TelemetryFrame&&) { FAIL() << "a frame came twice"; }), 0U);
}

TEST(Telemetry, AWaitSetWakesForAWriterWithoutHistory) {
  dds::Participant ground(own_endpoint());
  dds::Participant service(own_endpoint());
  dds::Reader<TelemetryFrame> reader(service);
  dds::WaitSet wait_set(service);
  wait_set.attach(reader);
  dds::Writer<TelemetryFrame> writer(ground, {.history = 0});
  while (writer.matched_readers() == 0) ASSERT_TRUE(wait_set.wait(10s));
  writer.write(make_frame(1));
  std::size_t taken = 0;
  while (taken == 0) {
    ASSERT_TRUE(wait_set.wait(10s));
    taken = reader.take(10, [](TelemetryFrame&&) {});
  }
  EXPECT_EQ(taken, 1U);
}

TEST(Telemetry, AWaitSetSleepsAgainAfterEachWriterWithoutHistory) {
  dds::Participant ground(own_endpoint());
  dds::Participant service(own_endpoint());
  dds::Reader<TelemetryFrame> reader(service);
  dds::WaitSet wait_set(service);
  wait_set.attach(reader);
  for (int i = 0; i < 2; ++i) {
    const dds::Writer<TelemetryFrame> writer(ground, {.history = 0});
    while (writer.matched_readers() == 0) ASSERT_TRUE(wait_set.wait(10s));
    EXPECT_TRUE(eventually([&] { return !wait_set.wait(20ms); })) << "writer " << i;
  }
}

TEST(Telemetry, AWriterWithoutHistoryIsHeardWherePartitionsArePatterns) {
  struct Case {
    const char* writer;
    const char* reader;
  };
  for (const Case& tested : {Case{"ops-*", "ops-1"}, {"ops-2", "ops-?"}, {"ops[3]", "ops[3]"}}) {
    dds::Participant ground({own_endpoint().domain, tested.writer});
    dds::Participant service({own_endpoint().domain, tested.reader});
    dds::Reader<TelemetryFrame> reader(service);
    dds::Writer<TelemetryFrame> writer(ground, {.history = 0});
    EXPECT_TRUE(eventually([&] { return reader.matched_writers() == 1; })) << tested.writer;
  }
}

/// A writer of telemetry that offers BEST_EFFORT.
class CarelessWriter {
 public:
  explicit CarelessWriter(dds::Participant& participant)
      : topic_(dds_create_topic(participant.impl().sessions.newest()->participant.get(),
                                &dds::Codec<TelemetryFrame>::descriptor, dds::telemetry_frame.topic,
                                nullptr, nullptr)) {
    const dds::Qos qos(dds_create_qos());
    dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
    writer_ = dds::Entity(dds_create_writer(participant.impl().sessions.newest()->publisher.get(),
                                            topic_.get(), qos.get(), nullptr));
  }

 private:
  dds::Entity topic_;
  dds::Entity writer_;
};

std::size_t occurrences(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

/// What is logged while the reader meets the writers, up to a reliable one that comes last.
std::string logged_until_reliable_writer(dds::Reader<TelemetryFrame>& reader,
                                         dds::Participant& ground) {
  testing::internal::CaptureStderr();
  const dds::Writer<TelemetryFrame> last(ground);
  EXPECT_TRUE(eventually([&] { return reader.matched_writers() == 1; }));
  reader.take(1, [](TelemetryFrame&&) {});
  return testing::internal::GetCapturedStderr();
}

TEST(Telemetry, BestEffortWritersAreWarnedOfOnce) {
  dds::Participant ground(own_endpoint());
  dds::Participant service(own_endpoint());
  const CarelessWriter early(ground);
  dds::Reader<TelemetryFrame> reader(service);
  const CarelessWriter late(ground);
  const std::string log = logged_until_reliable_writer(reader, ground);
  EXPECT_EQ(occurrences(log, "BEST_EFFORT"), 1U) << log;
  EXPECT_THAT(log, testing::HasSubstr("make it RELIABLE topic=satcs/TelemetryFrame"));
}

TEST(Telemetry, ABestEffortWriterOfAnotherPartitionIsNoneOfTheReadersBusiness) {
  dds::Endpoint training = own_endpoint();
  training.partition += "-training";
  dds::Participant ground(own_endpoint());
  dds::Participant school(training);
  dds::Participant service(own_endpoint());
  const CarelessWriter careless(school);
  dds::Reader<TelemetryFrame> reader(service);
  EXPECT_EQ(logged_until_reliable_writer(reader, ground), "");
}

TEST(Telemetry, PartitionsDoNotHearEachOther) {
  dds::Endpoint training = own_endpoint();
  training.partition += "-training";
  dds::Participant ground(own_endpoint());
  dds::Participant service(own_endpoint());
  dds::Participant school(training);
  dds::Writer<TelemetryFrame> writer(ground);
  dds::Reader<TelemetryFrame> hears(service);
  dds::Reader<TelemetryFrame> does_not(school);
  writer.write(make_frame(1));
  EXPECT_EQ(take_all(hears, 1).size(), 1U);
  EXPECT_EQ(does_not.matched_writers(), 0U);
  EXPECT_EQ(does_not.take(10, [](TelemetryFrame&&) {}), 0U);
}

TEST(Telemetry, AFullReaderMakesTheWriterWaitAndLosesNothing) {
  dds::Participant ground(own_endpoint());
  dds::Participant service(own_endpoint());
  dds::Reader<TelemetryFrame> reader(service, {.max_samples = 4});
  dds::Writer<TelemetryFrame> writer(ground, {.history = 0});
  ASSERT_TRUE(eventually([&] { return reader.matched_writers() == 1; }));
  std::thread sender([&] {
    for (std::uint64_t i = 1; i <= 2000; ++i) writer.write(make_frame(i));
  });
  const auto received = sequences(take_all(reader, 2000));
  sender.join();
  EXPECT_EQ(received, count_to(2000));
}

TEST(Telemetry, AWriterThatWaitsForRoomStopsWhenItIsAskedTo) {
  dds::Participant ground(own_endpoint());
  dds::Participant service(own_endpoint());
  dds::Reader<TelemetryFrame> reader(service, {.max_samples = 2});
  dds::Writer<TelemetryFrame> writer(ground);
  ASSERT_TRUE(eventually([&] { return writer.matched_readers() == 1; }));
  std::uint64_t written = 0;
  while (writer.write(make_frame(written + 1), [] { return true; })) ++written;
  EXPECT_EQ(written, 2U);
}

TEST(Telemetry, AReaderThatKeepsTheNewestMakesNoWriterWait) {
  dds::Participant ground(own_endpoint());
  dds::Participant simulator(own_endpoint());
  dds::Reader<TelemetryFrame> reader(simulator, {.keep_last = 10});
  dds::Writer<TelemetryFrame> writer(ground);
  ASSERT_TRUE(eventually([&] { return writer.matched_readers() == 1; }));
  for (std::uint64_t i = 1; i <= 1000; ++i) {
    ASSERT_TRUE(writer.write(make_frame(i), [] { return true; }));
  }
  ASSERT_TRUE(writer.wait_for_acknowledgments(10s));
  EXPECT_THAT(sequences(take_all(reader, 10)),
              testing::ElementsAre(991, 992, 993, 994, 995, 996, 997, 998, 999, 1000));
}

}  // namespace
}  // namespace reident::test::telemetry_test
