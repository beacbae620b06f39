#include "service/operations/protected_telemetry.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "service/model/model_json.hpp"
#include "service/operations/refresh.hpp"
#include "service/windows/provenance.hpp"
#include "storage/care/retention.hpp"
#include "storage/care/verify.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::protected_telemetry_test {
namespace {

using storage::DecisionKind;
using storage::ProtectedRange;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr storage::Time latest = std::numeric_limits<storage::Time>::max();

class ProtectedTelemetry : public DaemonTest {
 protected:
  ProtectedTelemetry() {
    archive.describe(descriptors());
    archive.append(telemetry(day, 1801));
  }

  /// The version of the window that ends at `end`, with a decision of that kind.
  std::int64_t record(storage::Time end, DecisionKind kind = DecisionKind::approve,
                      const std::string& outcome = "approved") {
    WindowCache kept = window_cache_of("SAT", plant());
    RefreshResult result =
        refresh(archive, registry, {"SAT", plant(), {end - plant().window, end}, "slide", "digest"},
                kept, {}, [] { return false; });
    result.attempt.outcome = outcome;
    return registry.record(result.attempt, result.version, {kind, "gate", "test"});
  }
  std::vector<ProtectedRange> ranges() const { return telemetry_of_versions(archive, registry); }
  void remove_all_but(const std::vector<ProtectedRange>& protection) {
    archive.compact();
    storage::Retention retention(archive, {.keep = minute}, protection, latest);
    while (retention.step()) {
    }
  }

  storage::Database database = open();
  storage::Archive archive{database, {.chunk_samples = 64}};
  storage::Registry registry{database};
};

TEST_F(ProtectedTelemetry, IsThatOfEachSignalInTheWindowAndTheHoldBeforeIt) {
  record(day + 10 * minute);
  const auto found = ranges();
  ASSERT_THAT(found, SizeIs(3));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found[i].spacecraft, "SAT");
    EXPECT_EQ(found[i].parameter, i + 1);
    EXPECT_EQ(found[i].range, (storage::TimeRange{day - plant().sample_hold, day + 10 * minute}));
  }
}

TEST_F(ProtectedTelemetry, IsThatOfEveryVersionThatWasEverPublishedAndOfNoOther) {
  record(day + 10 * minute, DecisionKind::reject);
  record(day + 10 * minute, DecisionKind::wait);
  EXPECT_THAT(ranges(), IsEmpty());
  const std::int64_t first = record(day + 15 * minute);
  record(day + 20 * minute);
  registry.decide("SAT", "PLANT", 4, {DecisionKind::withdraw, "Ana", "wrong"}, day);
  registry.decide("SAT", "PLANT", first, {DecisionKind::withdraw, "Ana", "wrong"}, day);
  EXPECT_THAT(ranges(), SizeIs(2 * 3)) << "withdrawn ones were published too";
}

TEST_F(ProtectedTelemetry, FollowsTheParametersOfAnExpression) {
  storage::NewAttempt attempt;
  attempt.spacecraft = "SAT";
  attempt.equipment = "PLANT";
  attempt.window = {day, day + 10 * minute};
  record(day + 10 * minute);
  EquipmentModel model = equipment_model_from_json(registry.version("SAT", "PLANT", 1)->model_json);
  model.inputs[0] = {"P", "W", 0, 1, "u * v"};
  registry.record(attempt, {to_json(model).dump(), "digest"}, {DecisionKind::approve, "gate", ""});
  EXPECT_THAT(ranges(), SizeIs(3 + 3)) << "u, v and y of both";
}

TEST_F(ProtectedTelemetry, IsAllOfTheSpacecraftWhereItIsNotKnownWhich) {
  record(day + 10 * minute);
  storage::ParameterDescriptor renamed = descriptors()[0];
  renamed.name = "u_new";
  archive.describe(std::vector{renamed});
  ASSERT_THAT(ranges(), SizeIs(3));
  EXPECT_EQ(ranges()[0].parameter, std::nullopt);

  storage::NewAttempt attempt;
  attempt.spacecraft = "SAT";
  attempt.equipment = "OTHER";
  attempt.window = {5, 9};
  registry.record(attempt, {"no model", "digest"}, {DecisionKind::approve, "gate", ""});
  const auto found = ranges();
  ASSERT_THAT(found, SizeIs(4));
  EXPECT_EQ(found[0].parameter, std::nullopt);
  EXPECT_EQ(found[0].range, (storage::TimeRange{5, 9}));
}

TEST_F(ProtectedTelemetry, LeavesAVersionReproducibleToTheLastBit) {
  record(day + 10 * minute);
  const std::uint64_t before = archive.sample_count();
  remove_all_but(ranges());
  EXPECT_LT(archive.sample_count(), before);
  EXPECT_TRUE(reproduce(archive, registry, *registry.version("SAT", "PLANT", 1), {}).same_model);
  remove_all_but({});
  EXPECT_FALSE(reproduce(archive, registry, *registry.version("SAT", "PLANT", 1), {}).same_samples);
}

TEST_F(ProtectedTelemetry, OfTheNextWindowsReachesBackFromWhereTelemetryOrTheClockEnds) {
  Config config;
  config.spacecraft = {{"SAT", {plant()}}, {"NONE", {plant()}}};
  const Duration back = plant().window + plant().slide + plant().sample_hold;
  auto found = telemetry_still_needed(archive, config, latest);
  ASSERT_THAT(found, SizeIs(3));
  EXPECT_EQ(found[2].parameter, 3U);
  EXPECT_EQ(found[2].range, (storage::TimeRange{day + 1800 * second + 1 - back, latest}));
  found = telemetry_still_needed(archive, config, day);
  EXPECT_EQ(found[0].range.begin, day - back);
}

TEST_F(ProtectedTelemetry, VerifyAsksForMistakesInVersions) {
  record(day + 10 * minute);
  const storage::Version good = *registry.version("SAT", "PLANT", 1);
  EXPECT_EQ(mistake_in(good), std::nullopt);
  const auto mistake = [&good](void (*change)(storage::Version&)) {
    storage::Version version = good;
    change(version);
    return mistake_in(version).value_or("none");
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(
      mistake([](auto& v) { v.model_json[v.model_json.size() / 2] ^= 1; }),
      ::testing::AnyOf(HasSubstr("cannot be read"), HasSubstr("digest"), HasSubstr("one of")));
  EXPECT_THAT(mistake([](auto& v) { v.digest[0] ^= 1; }), HasSubstr("its digest was made of"));
  EXPECT_THAT(mistake([](auto& v) { v.equipment = "OTHER"; }), HasSubstr("one of SAT/PLANT"));
  EXPECT_THAT(mistake([](auto& v) { v.provenance_json = "{"; }),
              HasSubstr("provenance cannot be read"));
  EXPECT_THAT(mistake([](auto& v) { v.window.end += 1; }),
              HasSubstr("another equipment or window"));
  EXPECT_EQ(mistake([](auto& v) { v.provenance_json.clear(); }), "none") << "from before schema 2";
}

}  // namespace
}  // namespace reident::test::protected_telemetry_test
