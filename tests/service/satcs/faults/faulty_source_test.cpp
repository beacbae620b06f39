#include "service/satcs/faults/faulty_source.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "service/satcs/reference/reference_source.hpp"
#include "tests/service/satcs/faults/faults_fixture.hpp"

namespace reident::satcs::faulty_source_test {
namespace {

using namespace test;
using storage::TelemetryFrame;

class Recorded : public FrameSource {
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

TEST(FaultySource, HandsOutAllThatIsReceivedAndAtItsEndWhatIsOnTheWay) {
  const std::vector<Fault> faults = {fault_of("frames_lost" + stretch),
                                     fault_of("repeated_day@+50min/+60min*86400")};
  const auto expected = received(true_frames(), faults);
  FaultySource source(std::make_unique<Recorded>(), faults, {});
  EXPECT_EQ(source.parameters(), parameters());
  TelemetryFrame frame;
  for (const TelemetryFrame& one : expected) {
    ASSERT_TRUE(source.next(frame));
    EXPECT_TRUE(same(frame, one));
  }
  EXPECT_FALSE(source.next(frame));
  EXPECT_FALSE(source.next(frame));
  EXPECT_EQ(source.progress(), 1);
}

TEST(FaultySource, RefusesWhatCannotBeToldOfItsTruth) {
  const std::vector<Fault> faults = {fault_of("stuck" + stretch + ":X")};
  EXPECT_THROW(FaultySource(std::make_unique<Recorded>(), faults, {}), std::invalid_argument);
}

TEST(ReferenceSource, NumbersItsFramesAndReceivesThemWhenTheyAreGenerated) {
  ReferenceOptions options;
  options.duration_ns = 3 * second;
  const auto real = reference_source(options, {.source = "station", .first_sequence = 7});
  const auto simulated = handwritten_source(options, {"simulator", storage::Origin::simulated});
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
}  // namespace reident::satcs::faulty_source_test
