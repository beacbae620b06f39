// Topics that hold a state: what late readers get, and what the end of a writer takes away.
#include <cmath>
#include <memory>

#include <gmock/gmock.h>

#include "service/dds/codec.hpp"
#include "service/dds/domain.hpp"
#include "tests/service/dds/child.hpp"
#include "tests/service/dds/dds_fixture.hpp"
#include "tests/service/model/example_model.hpp"

namespace reident::test::state_topics_test {
namespace {

TEST(StateTopics, ALateReaderGetsTheLastVersionOfEachEquipment) {
  dds::Participant service(own_endpoint());
  dds::Participant simulator(own_endpoint());
  dds::Writer<ModelVersion> writer(service);
  ModelVersion other = example_version(5);
  other.model.equipment = "MEA";
  writer.write(example_version(1));
  writer.write(example_version(2));
  writer.write(other);
  dds::Reader<ModelVersion> reader(simulator);
  std::map<std::string, std::int64_t> numbers;
  for (const ModelVersion& version : take_all(reader, 2)) {
    numbers[version.model.equipment] = version.number;
  }
  EXPECT_THAT(numbers, testing::ElementsAre(testing::Pair("BDR", 2), testing::Pair("MEA", 5)));
}

TEST(StateTopics, TheEndOfTheServiceDisposesOfNoModel) {
  dds::Participant simulator(own_endpoint());
  auto service = std::make_unique<dds::Participant>(own_endpoint());
  auto writer = std::make_unique<dds::Writer<ModelVersion>>(*service);
  dds::Reader<ModelVersion> reader(simulator);
  writer->write(example_version(1));
  ASSERT_TRUE(eventually([&] { return reader.matched_writers() == 1; }));
  writer.reset();
  service.reset();
  ASSERT_TRUE(eventually([&] { return reader.matched_writers() == 0; }));
  EXPECT_EQ(take_all(reader, 1).size(), 1U);
}

TEST(StateTopics, EveryMessageArrivesAsItWasSent) {
  dds::Participant participant(own_endpoint());
  dds::Writer<IdentificationReport> reports(participant);
  dds::Writer<ModelAcknowledgement> acknowledgements(participant);
  dds::Writer<ServiceStatus> statuses(participant);
  dds::Writer<storage::ParameterDescriptor> descriptors(participant);
  const storage::ParameterDescriptor descriptor{
      "CBERS4", 9, "V_BUS", "V", "", storage::ParameterKind::digital, 1.5, std::nullopt};
  reports.write({"CBERS4", "BDR", 7, {10, 20}, "slide", "unstable", "why", 3, 4, 1, 2, NAN, 99});
  const RunningModel running{2, 4, "following", true, 41, 42, 1.25, 0.5, 60, 70, 100, 7000};
  acknowledgements.write(
      {"trainer", "CBERS4", "BDR", 3, "ab", false, "no", running, "console", 77, "0.1.0"});
  ServiceStatus status;
  status.service = "reident";
  status.frames_received = 12345678901234;
  status.last_error = "disk full";
  status.failing_champions = "CBERS-4/MEA";
  statuses.write(status);
  descriptors.write(descriptor);

  dds::Reader<IdentificationReport> report_reader(participant);
  dds::Reader<ModelAcknowledgement> acknowledgement_reader(participant);
  dds::Reader<ServiceStatus> status_reader(participant);
  dds::Reader<storage::ParameterDescriptor> descriptor_reader(participant);
  const auto report = take_all(report_reader, 1).at(0);
  EXPECT_EQ(report.attempt, 7);
  EXPECT_EQ(report.window, (storage::TimeRange{10, 20}));
  EXPECT_EQ(report.outcome, "unstable");
  EXPECT_EQ(report.order, 4);
  EXPECT_TRUE(std::isnan(report.champion_mrse_percent));
  const auto acknowledgement = take_all(acknowledgement_reader, 1).at(0);
  EXPECT_EQ(acknowledgement.simulator, "trainer");
  EXPECT_FALSE(acknowledgement.accepted);
  EXPECT_EQ(acknowledgement.reason, "no");
  EXPECT_EQ(acknowledgement.running, running);
  EXPECT_EQ(acknowledgement.host, "console");
  EXPECT_EQ(acknowledgement.process, 77U);
  EXPECT_EQ(acknowledgement.program_version, "0.1.0");
  const auto heartbeat = take_all(status_reader, 1).at(0);
  EXPECT_EQ(heartbeat.frames_received, 12345678901234U);
  EXPECT_EQ(heartbeat.last_error, "disk full");
  EXPECT_EQ(heartbeat.failing_champions, "CBERS-4/MEA");
  EXPECT_EQ(take_all(descriptor_reader, 1).at(0), descriptor);
}

TEST(StateTopics, AMalformedMessageIsCountedAndTheNextOneArrives) {
  dds::Participant participant(own_endpoint());
  dds::Reader<ModelVersion> reader(participant);
  dds::Writer<ModelVersion> writer(participant);
  // A program of somebody else's, which checks nothing.
  dds::Codec<ModelVersion>::Encoder encode;
  const ModelVersion good = example_version(2);
  reident_ModelVersion wire = encode(good);
  wire.order = 40;
  const dds::Entity topic(
      dds_create_topic(participant.impl().sessions.newest()->participant.get(),
                       &reident_ModelVersion_desc, "reident/ModelVersion", nullptr, nullptr),
      "dds_create_topic", "test");
  const dds::Entity careless(
      dds_create_writer(participant.impl().sessions.newest()->publisher.get(), topic.get(),
                        dds::writer_qos(dds::model_version, {}).get(), nullptr),
      "dds_create_writer", "test");
  ASSERT_EQ(dds_write(careless.get(), &wire), DDS_RETCODE_OK);
  ModelVersion refused;
  ASSERT_TRUE(eventually([&] {
    reader.take(
        10, [](ModelVersion&&) { FAIL(); },
        [&](const ModelVersion& message, const std::string&) { refused = message; });
    return reader.malformed() == 1;
  }));
  EXPECT_EQ(refused.model.equipment, "BDR");
  EXPECT_EQ(refused.number, 2);
  EXPECT_THAT(reader.last_malformed(), testing::HasSubstr("40 x 40"));
  writer.write(example_version(3));
  EXPECT_EQ(take_all(reader, 1).at(0).number, 3);
}

TEST(Processes, SixteenTakePartInOneDomainOnOneMachine) {
  const dds::Endpoint endpoint = own_endpoint();
  dds::Participant participant(endpoint);
  dds::Reader<storage::TelemetryFrame> reader(participant, {.max_samples = 1});
  std::vector<std::unique_ptr<Child>> children;
  for (int i = 0; i < 16; ++i) {
    children.push_back(std::make_unique<Child>(std::vector<std::string>{
        FRAME_SENDER, std::to_string(endpoint.domain), endpoint.partition, "1", "1000000", "1"}));
  }
  EXPECT_TRUE(eventually([&] { return reader.matched_writers() == 16; }, 30s));
}

TEST(Participants, OfOneProcessShareADomainAndLeaveItOneByOne) {
  const dds::Endpoint endpoint = own_endpoint();
  auto first = std::make_unique<dds::Participant>(endpoint);
  dds::Participant second(endpoint);
  first.reset();
  dds::Participant third(endpoint);
  dds::Writer<ServiceStatus> writer(second);
  dds::Reader<ServiceStatus> reader(third);
  ServiceStatus status;
  status.service = "reident";
  writer.write(status);
  EXPECT_EQ(take_all(reader, 1).size(), 1U);
}

TEST(Participants, ThatCannotJoinSayWhichDomainAndWhatToDo) {
  try {
    const dds::Participant participant({.domain = 4'000'000});
    FAIL() << "it joined";
  } catch (const dds::Error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("domain 4000000"),
                                             testing::HasSubstr("use a domain from 0 to 230")));
  }
}

TEST(Participants, AReaderWithAnImpossibleBoundNamesTheTopic) {
  dds::Participant participant(own_endpoint());
  try {
    const dds::Reader<storage::TelemetryFrame> reader(participant, {.max_samples = -7});
    FAIL() << "it was made";
  } catch (const dds::Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("satcs/TelemetryFrame"));
  }
}

}  // namespace
}  // namespace reident::test::state_topics_test
