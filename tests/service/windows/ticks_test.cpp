#include "service/windows/ticks.hpp"

#include <gmock/gmock.h>

#include "service/operations/refresh.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::ticks_test {
namespace {

constexpr Duration ms = second / 1000;

/// How far behind each second the samples come.
struct Behind {
  Duration inputs, output, jitter;
};

/// Inputs and output of the plant in packets of their own, half an hour from `begin` on.
std::vector<storage::TelemetryFrame> packets(std::vector<storage::TelemetryFrame> frames,
                                             const Behind& behind) {
  std::vector<storage::TelemetryFrame> sent;
  Duration jitter = 0;
  for (storage::TelemetryFrame& frame : frames) {
    jitter = (jitter + 3) % 7;
    const storage::Time time = frame.generation_time + (jitter - 3) * behind.jitter / 3;
    storage::TelemetryFrame late = frame;
    late.samples = {frame.samples[2]};
    frame.samples.pop_back();
    frame.sequence = 2 * frame.sequence + 1;
    late.sequence = frame.sequence + 1;
    frame.generation_time = frame.reception_time = time + behind.inputs;
    late.generation_time = late.reception_time = time + behind.output;
    sent.push_back(frame);
    sent.push_back(late);
  }
  return sent;
}

class Ticks : public DaemonTest {
 protected:
  void receive(storage::Time begin, const Behind& behind) {
    archive.append(packets(telemetry(begin, 1801), behind));
  }
  std::optional<Duration> phase(const EquipmentConfig& equipment = plant()) const {
    return with_phase(equipment, "SAT", archive, registry).phase;
  }
  std::string advice(const EquipmentConfig& equipment = plant()) const {
    return advised_phase(archive, registry, "SAT", equipment, day + 60 * minute).value_or("none");
  }
  /// Records a version of the first window.
  void try_window(const EquipmentConfig& equipment) {
    WindowCache kept = window_cache_of("SAT", equipment);
    const RefreshResult result =
        refresh(archive, registry, {"SAT", equipment, {day, day + 10 * minute}, "slide", "digest"},
                kept, {}, [] { return false; });
    ASSERT_TRUE(result.candidate);
    registry.record(result.attempt, result.version, *result.decision);
  }

  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST_F(Ticks, StandWhereTheFirstSamplesThatBelongTogetherHaveCome) {
  EXPECT_FALSE(phase()) << "no telemetry says so yet";
  const std::pair<Behind, Duration> cases[] = {
      {{0, 0, 0}, 0},
      {{300 * ms, 300 * ms, 0}, 0},
      {{800 * ms, 1000 * ms, 0}, 0},
      {{0, 0, 45 * ms}, 100 * ms},
      {{0, 200 * ms, 0}, 200 * ms},
      {{0, 2200 * ms, 0}, 200 * ms},
      {{0, 180 * ms, 45 * ms}, 230 * ms},
  };
  for (const auto& [behind, expected] : cases) {
    const TemporaryFolder folder;
    storage::Database own(folder / "a.db", storage::Database::Mode::read_write);
    storage::Archive other(own);
    other.describe(descriptors());
    other.append(packets(telemetry(day, 1801), behind));
    EXPECT_EQ(with_phase(plant(), "SAT", other, storage::Registry(own)).phase, expected)
        << behind.inputs << " " << behind.output << " " << behind.jitter;
    EXPECT_EQ(advised_phase(other, storage::Registry(own), "SAT", plant(), day + 30 * minute),
              std::nullopt);
  }
}

TEST_F(Ticks, StayWhereTheNewestVersionHasThem) {
  archive.describe(descriptors());
  receive(day, {0, 0, 0});
  receive(day + 30 * minute + second, {0, 200 * ms, 0});
  EXPECT_EQ(phase(), 0) << "by the first telemetry";
  EquipmentConfig configured = plant();
  configured.phase = 150 * ms;
  EXPECT_EQ(phase(configured), 150 * ms);
  EXPECT_EQ(advice(configured), "none");
  try_window(configured);
  EXPECT_EQ(phase(), 150 * ms);
  EquipmentConfig other = plant();
  other.inputs = {"u"};
  EXPECT_EQ(phase(other), 0) << "no version was made of this telemetry";
  EXPECT_THAT(advice(), testing::AllOf(testing::HasSubstr("SAT/PLANT: "),
                                       testing::HasSubstr("phase = \"200ms\"")));
}

}  // namespace
}  // namespace reident::test::ticks_test
