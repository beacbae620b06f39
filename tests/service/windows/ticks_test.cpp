#include "service/windows/ticks.hpp"

#include <gmock/gmock.h>

namespace reident::test::ticks_test {
namespace {

constexpr Duration second = 1'000'000'000;

/// Samples of parameters 1 and 2, called u and y, each second, so long behind it.
class Packets final : public storage::SampleReader {
 public:
  Packets(Duration u_behind, Duration y_behind, Duration jitter)
      : behind_{u_behind, y_behind}, jitter_(jitter) {}

  std::optional<storage::ParameterDescriptor> parameter(const std::string&,
                                                        const std::string& name) const override {
    storage::ParameterDescriptor descriptor;
    descriptor.id = name == "u" ? 1 : 2;
    return descriptor;
  }
  storage::Series read(const std::string&, storage::Origin, std::uint32_t parameter,
                       storage::TimeRange range) const override {
    storage::Series series;
    for (storage::Time tick = 0; tick < 5000; ++tick) {
      const storage::Time time =
          tick * second + behind_.at(parameter - 1) + (tick % 7 - 3) * jitter_ / 3;
      if (time >= range.begin && time < range.end) series.time.push_back(time);
    }
    return series;
  }

 private:
  std::vector<Duration> behind_;
  Duration jitter_;
};

TEST(Ticks, AreAdvisedWhereSamplesThatBelongTogetherLieOnBothSidesOfThem) {
  EquipmentConfig equipment;
  equipment.name = "E";
  equipment.inputs = {"u"};
  equipment.outputs = {"y"};
  equipment.sample_period = second;
  const auto advice = [&](Duration u_behind, Duration y_behind, Duration jitter) {
    return advised_phase(Packets(u_behind, y_behind, jitter), "SAT", equipment, 5000 * second)
        .value_or("none");
  };
  const Duration ms = second / 1000;
  EXPECT_EQ(advice(0, 0, 0), "none");
  EXPECT_EQ(advice(300 * ms, 300 * ms, 0), "none");
  EXPECT_EQ(advice(800 * ms, 1000 * ms, 0), "none");
  EXPECT_THAT(advice(0, 0, 45 * ms), testing::HasSubstr("phase = \"100ms\""));
  EXPECT_THAT(advice(0, 200 * ms, 0), testing::HasSubstr("SAT/E: "));
  EXPECT_THAT(advice(0, 200 * ms, 0), testing::HasSubstr("phase = \"200ms\""));
  equipment.phase = 200 * ms;
  EXPECT_EQ(advice(0, 200 * ms, 0), "none");
}

}  // namespace
}  // namespace reident::test::ticks_test
