// A writer in another process at full speed against a reader that is far slower than it.
#include <memory>
#include <optional>
#include <set>

#include "tests/service/dds/child.hpp"
#include "tests/service/dds/dds_fixture.hpp"

namespace reident::test::back_pressure_test {
namespace {

using storage::TelemetryFrame;

std::vector<std::string> sender(const dds::Endpoint& endpoint, int history, std::size_t count,
                                std::size_t samples) {
  return {FRAME_SENDER,          std::to_string(endpoint.domain),
          endpoint.partition,    std::to_string(history),
          std::to_string(count), std::to_string(samples)};
}

/// Takes a few frames at a time and checks that they are 1, 2, 3, ...
std::uint64_t take_in_order(dds::Participant& participant, dds::Reader<TelemetryFrame>& reader,
                            std::uint64_t count) {
  dds::WaitSet wait_set(participant);
  wait_set.attach(reader);
  std::uint64_t next = 1;
  while (next <= count && !testing::Test::HasFailure() && wait_set.wait(20s)) {
    reader.take(5, [&](TelemetryFrame&& frame) {
      EXPECT_EQ(frame.sequence, next);
      next = frame.sequence + 1;
    });
  }
  return next - 1;
}

class BackPressure : public testing::TestWithParam<int> {};

TEST_P(BackPressure, ATinyReaderGetsEveryFrameOfAFastProcessThatEnds) {
  constexpr std::uint64_t count = 50'000;
  const dds::Endpoint endpoint = own_endpoint();
  dds::Participant participant(endpoint);
  dds::Reader<TelemetryFrame> reader(participant, {.max_samples = 64});
  Child child(sender(endpoint, GetParam(), count, 20));
  EXPECT_EQ(take_in_order(participant, reader, count), count);
  EXPECT_EQ(child.wait(), 0);
  EXPECT_EQ(reader.malformed(), 0U);
}

INSTANTIATE_TEST_SUITE_P(with_and_without_history, BackPressure, testing::Values(0, 1, 1000));

TEST(CleanStop, HandsOutAllThatWasAcknowledgedAndMoreStaysWithTheSender) {
  const dds::Endpoint endpoint = own_endpoint();
  dds::Participant participant(endpoint);
  dds::Reader<TelemetryFrame> reader(participant, {.max_samples = 16});
  Child child(sender(endpoint, 1, 1000, 20));
  std::vector<TelemetryFrame> received = take_all(reader, 100);
  participant.stop_hearing();
  reader.drain([&](TelemetryFrame&& frame) { received.push_back(std::move(frame)); });
  EXPECT_EQ(sequences(received), count_to(received.size()));
  EXPECT_LT(received.size(), 1000U);
  EXPECT_EQ(reader.take(10, [](TelemetryFrame&&) {}), 0U);
}

TEST(CleanStop, AFullReaderOfSeveralBusyProcessesGoesAtOnce) {
  const dds::Endpoint endpoint = own_endpoint();
  dds::Participant participant(endpoint);
  std::optional<dds::Reader<TelemetryFrame>> reader(std::in_place, participant,
                                                    dds::ReaderOptions{.max_samples = 4});
  std::vector<std::unique_ptr<Child>> children;
  for (int i = 0; i < 4; ++i) {
    children.push_back(std::make_unique<Child>(sender(endpoint, 1, 1'000'000, 20)));
  }
  ASSERT_TRUE(eventually([&] { return reader->matched_writers() == 4; }));
  ASSERT_TRUE(eventually([&] { return reader->take(1, [](TelemetryFrame&&) {}) == 1; }));
  const auto begin = std::chrono::steady_clock::now();
  reader.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 1s);
}

TEST(CleanStop, UnderASenderAtFullSpeedThatKeepsHistoryLeavesNothingOut) {
  constexpr std::uint64_t count = 20'000;
  const dds::Endpoint endpoint = own_endpoint();
  dds::Participant participant(endpoint);
  std::set<std::uint64_t> received;
  const auto keep = [&](TelemetryFrame&& frame) { received.insert(frame.sequence); };
  std::optional<dds::Reader<TelemetryFrame>> reader(std::in_place, participant);
  Child child(sender(endpoint, count, count, 20));
  ASSERT_TRUE(eventually([&] { return reader->take(100, keep) > 0 && received.size() > 500; }));
  participant.stop_hearing();
  reader->drain(keep);
  reader.reset();
  EXPECT_LT(received.size(), count) << "the sender was still at work";
  participant.hear_again();

  reader.emplace(participant);
  EXPECT_TRUE(eventually([&] {
    reader->take(1000, keep);
    return received.size() == count;
  })) << received.size();
  EXPECT_EQ(child.wait(), 0);
}

}  // namespace
}  // namespace reident::test::back_pressure_test
