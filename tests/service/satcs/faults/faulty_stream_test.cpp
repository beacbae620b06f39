#include "service/satcs/faults/faulty_stream.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "service/satcs/reference/reference_stream.hpp"
#include "tests/service/satcs/faults/faults_fixture.hpp"

namespace reident::satcs::faulty_stream_test {
namespace {

using namespace test;
using storage::TelemetryFrame;

class Recorded : public FrameStream {
 public:
  std::vector<storage::ParameterDescriptor> parameters() const override {
    return test::parameters();
  }
  bool next(TelemetryFrame& frame) override {
    if (handed_out_ == frames_.size()) return false;
    frame = frames_[handed_out_++];
    return true;
  }
  double progress() const override {
    return static_cast<double>(handed_out_) / static_cast<double>(frames_.size());
  }

 private:
  std::vector<TelemetryFrame> frames_ = true_frames();
  std::size_t handed_out_ = 0;
};

TEST(FaultyStream, HandsOutAllThatIsReceivedAndAtItsEndWhatIsOnTheWay) {
  const std::vector<Fault> faults = {fault_of("frames_lost" + fault_range),
                                     fault_of("repeated_day@+50min/+60min*86400")};
  const auto expected = received(true_frames(), faults);
  FaultyStream stream(std::make_unique<Recorded>(), faults, {});
  EXPECT_EQ(stream.parameters(), parameters());
  TelemetryFrame frame;
  for (const TelemetryFrame& one : expected) {
    ASSERT_TRUE(stream.next(frame));
    EXPECT_TRUE(same(frame, one));
  }
  EXPECT_FALSE(stream.next(frame));
  EXPECT_FALSE(stream.next(frame));
  EXPECT_EQ(stream.progress(), 1);
}

TEST(FaultyStream, RefusesWhatCannotBeToldOfItsTruth) {
  const std::vector<Fault> faults = {fault_of("stuck" + fault_range + ":X")};
  EXPECT_THROW(FaultyStream(std::make_unique<Recorded>(), faults, {}), std::invalid_argument);
}

TEST(ReferenceStream, NumbersItsFramesAndReceivesThemWhenTheyAreGenerated) {
  ReferenceOptions options;
  options.duration_ns = 3 * second;
  const auto real = reference_stream(options, {.source = "station", .first_sequence = 7});
  const auto simulated = handwritten_stream(options, {"simulator", storage::Origin::simulated});
  TelemetryFrame frame;
  for (int k = 0; k < 3; ++k) {
    const Time time = options.start + k * second;
    ASSERT_TRUE(real->next(frame));
    EXPECT_EQ(frame.source, "station");
    EXPECT_EQ(frame.origin, storage::Origin::real);
    EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(7 + k));
    EXPECT_EQ(frame.generation_time, time);
    EXPECT_EQ(frame.reception_time, time);
    ASSERT_TRUE(simulated->next(frame));
    EXPECT_EQ(frame.source, "simulator");
    EXPECT_EQ(frame.origin, storage::Origin::simulated);
    EXPECT_EQ(frame.sequence, static_cast<std::uint64_t>(1 + k));
    EXPECT_EQ(frame.generation_time, time);
  }
  EXPECT_FALSE(real->next(frame));
  EXPECT_FALSE(simulated->next(frame));
}

}  // namespace
}  // namespace reident::satcs::faulty_stream_test
