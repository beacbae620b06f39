// Telemetry with sensor faults, on its way to a candidate and a version.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "service/operations/protected_telemetry.hpp"
#include "service/operations/refresh.hpp"
#include "service/windows/provenance.hpp"
#include "tests/service/daemon_fixture.hpp"
#include "tests/service/reason_codes.hpp"

namespace reident::test::telemetry_checks_test {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// The plant of the fixture with a second sensor of the output, y2, and one of u, u2.
class FaultySensors : public DaemonTest {
 protected:
  FaultySensors() {
    auto all = descriptors();
    for (const char* name : {"y2", "u2"}) {
      all.push_back(all.back());
      all.back().id = static_cast<std::uint32_t>(all.size());
      all.back().name = name;
    }
    archive.describe(all);
  }

  static std::vector<storage::TelemetryFrame> frames(storage::Time begin, int seconds) {
    auto result = telemetry(begin, seconds);
    for (storage::TelemetryFrame& frame : result) {
      frame.samples.push_back({4, storage::Quality::good, frame.samples[2].value + 0.02});
      frame.samples.push_back({5, storage::Quality::good, frame.samples[0].value});
    }
    return result;
  }
  static void bias(std::vector<storage::TelemetryFrame>& frames, int begin, int end, double by) {
    for (int k = begin; k < end; ++k) frames[static_cast<std::size_t>(k)].samples[2].value += by;
  }

  static EquipmentConfig bound() {
    EquipmentConfig equipment = plant();
    equipment.window = 20 * minute;
    equipment.relations = {{"second sensor", "y - y2", 0.1}};
    return equipment;
  }
  RefreshRequest request(storage::Time end, const EquipmentConfig& equipment) const {
    return {"SAT", equipment, {end - equipment.window, end}, "slide", "digest"};
  }
  RefreshResult run(storage::Time end, const EquipmentConfig& equipment = bound()) const {
    WindowCache kept = window_cache_of("SAT", equipment);
    return run(end, kept, equipment);
  }
  RefreshResult run(storage::Time end, WindowCache& kept,
                    const EquipmentConfig& equipment = bound()) const {
    return refresh(archive, registry, request(end, equipment), kept, {}, [] { return false; });
  }

  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST(FaultShare, IsOfTheTicksAlone) {
  Plausibility found;
  found.holes = {{0, 5}, {9, 12}, {18, 19}, {30, 31}};
  EXPECT_EQ(fault_share(found, {10, 30}), 2.0 / 20);
}

TEST_F(FaultySensors, AreLeftOutWhereARelationDoesNotHold) {
  auto lied = frames(day, 1201);
  bias(lied, 300, 600, 0.3);
  archive.append(lied);
  const RefreshResult result = run(day + 20 * minute);
  ASSERT_TRUE(result.candidate) << result.attempt.reason;
  const auto evidence = nlohmann::json::parse(result.attempt.evidence_json);
  EXPECT_NEAR(double(evidence["coverage"]), 0.65, 0.05);
  const auto& told = evidence["implausible"]["longest"][0];
  EXPECT_EQ(told["relation"], "second sensor");
  EXPECT_NEAR(double(told["residual"]), 0.28, 0.02);
  EXPECT_NEAR(double(std::int64_t(told["begin_ns"]) - day) / double(second), 240, 20);

  EquipmentConfig believing = bound();
  believing.relations.clear();
  EXPECT_GT(run(day + 20 * minute, believing).evidence.mrse_percent, result.evidence.mrse_percent);
}

TEST_F(FaultySensors, OnTooMuchOfAWindowAreAVerdictThatNamesThem) {
  auto lied = frames(day, 1201);
  bias(lied, 300, 1201, -4);
  archive.append(lied);
  const RefreshResult result = run(day + 20 * minute);
  EXPECT_EQ(result.attempt.outcome, "implausible");
  EXPECT_FALSE(result.candidate);
  const std::string worst = reasons_in(result.attempt.evidence_json)[0]["worst"];
  EXPECT_THAT(worst, HasSubstr("relation second sensor (y - y2) does not hold"));
  EXPECT_THAT(worst, HasSubstr("one of y, y2 is wrong"));
}

TEST_F(FaultySensors, AreNoConcernOfARelationThatNobodyHasDescribed) {
  EquipmentConfig equipment = bound();
  equipment.relations = {{"third sensor", "y - y3", 0.1}};
  archive.append(frames(day, 1201));
  const RefreshResult result = run(day + 20 * minute, equipment);
  EXPECT_EQ(result.attempt.outcome, "challenger") << result.attempt.reason;
  EXPECT_THAT(result.attempt.evidence_json, HasSubstr("telemetry has not described y3"));
  const auto unbound = [](const RefreshResult& of) {
    return nlohmann::json::parse(of.attempt.evidence_json)["limits"]["unbound"];
  };
  EXPECT_EQ(unbound(result), nlohmann::json({"u", "v", "y"}));
  EXPECT_EQ(unbound(run(day + 20 * minute)), nlohmann::json({"u", "v"}));
  EXPECT_TRUE(applying_relations(archive, "SAT", equipment).empty());
  EXPECT_EQ(applying_relations(archive, "SAT", bound()).size(), 1);
}

TEST_F(FaultySensors, GiveTheSameBitsWhateverWasKeptOfEarlierWindows) {
  auto lied = frames(day, 2401);
  bias(lied, 700, 900, 0.3);
  bias(lied, 1900, 2100, 0.08);  // a shift within the tolerance
  lied[1000].samples[2].value += 50;
  archive.append(lied);
  WindowCache kept = window_cache_of("SAT", bound());
  for (const int minutes : {20, 25, 30, 35, 40, 20}) {
    const RefreshResult one = run(day + minutes * minute, kept);
    const RefreshResult other = run(day + minutes * minute);
    ASSERT_EQ(one.candidate.has_value(), other.candidate.has_value()) << minutes;
    EXPECT_EQ(one.version.digest, other.version.digest) << minutes;
    EXPECT_EQ(one.version.samples_digest, other.version.samples_digest) << minutes;
  }
}

TEST_F(FaultySensors, LeaveAVersionThatCanBeReproduced) {
  auto lied = frames(day, 1201);
  bias(lied, 300, 600, 0.3);
  lied[900].samples[2].value += 50;
  archive.append(lied);
  const RefreshResult result = run(day + 20 * minute);
  ASSERT_TRUE(result.candidate) << result.attempt.reason;
  registry.record(result.attempt, result.version, *result.decision);
  const Reproduction again = reproduce(archive, registry, *registry.version("SAT", "PLANT", 1), {});
  EXPECT_TRUE(again.same_samples);
  EXPECT_TRUE(again.same_model);
}

TEST_F(FaultySensors, AreKeptWithTheTelemetryOfTheVersion) {
  archive.append(frames(day, 1201));
  const RefreshResult result = run(day + 20 * minute);
  registry.record(result.attempt, result.version, *result.decision);
  registry.decide("SAT", "PLANT", 1, {storage::DecisionKind::approve, "Ana", ""}, day);
  std::vector<std::uint32_t> parameters;
  for (const storage::ProtectedRange& one : telemetry_of_versions(archive, registry))
    if (one.parameter) parameters.push_back(*one.parameter);
  EXPECT_THAT(parameters, Contains(4U)) << "y2";
}

TEST_F(FaultySensors, WithoutARelationAreFoundWhereOneIsStuck) {
  auto lied = frames(day, 1201);
  for (std::size_t k = 400; k < 700; ++k) lied[k].samples[2].value = lied[399].samples[2].value;
  archive.append(lied);
  EquipmentConfig equipment = bound();
  equipment.relations.clear();
  const auto evidence =
      nlohmann::json::parse(run(day + 20 * minute, equipment).attempt.evidence_json);
  EXPECT_EQ(evidence["implausible"]["longest"][0]["check"], "stuck");
  EXPECT_EQ(evidence["implausible"]["longest"][0]["parameters"][0], "y");
  EXPECT_EQ(evidence["coverage"], 0.75 - 1. / 1200);

  equipment.screening = false;
  EXPECT_THAT(run(day + 20 * minute, equipment).attempt.evidence_json,
              testing::Not(HasSubstr("implausible")));
}

}  // namespace
}  // namespace reident::test::telemetry_checks_test
