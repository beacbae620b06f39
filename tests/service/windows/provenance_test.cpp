#include "service/windows/provenance.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "service/model/regime_inputs.hpp"
#include "service/operations/refresh.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::provenance_test {
namespace {

class Provenance : public DaemonTest {
 protected:
  Provenance() {
    archive.describe(descriptors());
    auto frames = telemetry(day, 901);
    late.assign(frames.begin() + 100, frames.begin() + 120);
    frames.erase(frames.begin() + 100, frames.begin() + 120);
    archive.append(frames);
  }

  storage::Version record(storage::Time end, WindowCache& kept) {
    const RefreshResult result =
        refresh(archive, registry, {"SAT", plant(), {end - plant().window, end}, "slide", "digest"},
                kept, {}, [] { return false; });
    const std::int64_t number = registry.record(result.attempt, result.version, *result.decision);
    return *registry.version("SAT", "PLANT", number);
  }

  std::vector<storage::TelemetryFrame> late;  // of 20 seconds that the archive does not have yet
  storage::Database database = open();
  storage::Archive archive{database};
  storage::Registry registry{database};
};

TEST_F(Provenance, NamesItsThreeParts) {
  WindowCache kept = window_cache_of("SAT", plant());
  const auto json = nlohmann::json::parse(record(day + 10 * minute, kept).provenance_json);
  const auto& parts = json["parts"];
  EXPECT_EQ(parts["identify"]["rows"], (std::vector{0, 291}));
  EXPECT_EQ(parts["tune"]["rows"], (std::vector{291, 407}));
  EXPECT_EQ(parts["validate"]["rows"], (std::vector{407, 582}));
  EXPECT_EQ(parts["identify"]["end_ns"], parts["tune"]["begin_ns"]);
  EXPECT_EQ(parts["tune"]["end_ns"], parts["validate"]["begin_ns"]);
}

TEST_F(Provenance, IsEnoughToIdentifyTheVersionAgainToTheLastBit) {
  WindowCache kept = window_cache_of("SAT", plant());
  record(day + 10 * minute, kept);
  const Reproduction again = reproduce(archive, registry, *registry.version("SAT", "PLANT", 1), {});
  EXPECT_TRUE(again.same_samples);
  EXPECT_TRUE(again.same_model);
}

TEST_F(Provenance, IsEnoughForAVersionThatTheGateTurnedAway) {
  WindowCache kept = window_cache_of("SAT", plant());
  record(day + 10 * minute, kept);
  const storage::Version turned_away = record(day + 15 * minute, kept);
  ASSERT_EQ(registry.champion("SAT", "PLANT")->number, 1);
  const Reproduction again = reproduce(archive, registry, turned_away, {});
  EXPECT_TRUE(again.same_samples);
  EXPECT_TRUE(again.same_model);
}

TEST_F(Provenance, IsEnoughForAVersionThatTheChampionWasAdaptedTo) {
  WindowCache kept = window_cache_of("SAT", plant());
  record(day + 10 * minute, kept);
  registry.decide("SAT", "PLANT", 1, {storage::DecisionKind::approve, "Ana", ""}, day);
  archive.append(telemetry(day + 901 * second, 600, 1.5, 0.3));  // noise spoils a new A and C
  const storage::Version version = record(day + 25 * minute, kept);
  ASSERT_EQ(nlohmann::json::parse(version.provenance_json).value("adapted_from", 0), 1)
      << registry.attempt(version.attempt)->evidence_json;
  const Reproduction again = reproduce(archive, registry, version, {});
  EXPECT_TRUE(again.same_samples);
  EXPECT_TRUE(again.same_model);
  storage::Version lost = version;
  lost.equipment = "ANOTHER";
  lost.provenance_json.replace(lost.provenance_json.find("\"PLANT\""), 7, "\"OTHER\"");
  EXPECT_THROW(reproduce(archive, registry, lost, {}), std::invalid_argument);
}

TEST_F(Provenance, ReadsTheWindowAsItWasWhenTelemetryCameLate) {
  WindowCache kept = window_cache_of("SAT", plant());
  archive.seal("SAT", day + 10 * minute);
  const storage::Version version = record(day + 10 * minute, kept);
  const std::span<const storage::TelemetryFrame> frames(late);
  archive.append(frames.first(10));
  std::vector<storage::TelemetryFrame> worse(frames.begin(), frames.end());
  for (storage::TelemetryFrame& frame : worse)
    for (storage::Sample& sample : frame.samples) sample.quality = storage::Quality::suspect;
  archive.append(std::span(worse).subspan(10));
  archive.append(frames.subspan(10));  // better ones in their place
  archive.compact();
  const Reproduction again = reproduce(archive, registry, version, {});
  EXPECT_EQ(again.revisions, 3U);
  EXPECT_TRUE(again.same_samples);
  EXPECT_TRUE(again.same_model);
}

TEST_F(Provenance, OfAVersionWithRegimesIsEnoughToo) {
  archive.append(late);
  EquipmentConfig equipment = plant();
  add_regime_inputs({"v > 0.5"}, equipment.inputs, equipment.derived);
  equipment.regime_inputs = 3;
  WindowCache kept = window_cache_of("SAT", equipment);
  const storage::Time end = day + 10 * minute;
  const RefreshResult result = refresh(
      archive, registry, {"SAT", equipment, {end - equipment.window, end}, "slide", "digest"}, kept,
      {}, [] { return false; });
  registry.record(result.attempt, result.version, *result.decision);
  const storage::Version version = *registry.version("SAT", "PLANT", 1);
  EXPECT_THAT(result.attempt.evidence_json, testing::HasSubstr("held_out_error_without"));
  const Reproduction again = reproduce(archive, registry, version, {});
  EXPECT_TRUE(again.same_samples);
  EXPECT_TRUE(again.same_model);
}

TEST_F(Provenance, TellsThatTheTelemetryOfTheWindowHasChangedSince) {
  WindowCache kept = window_cache_of("SAT", plant());
  const storage::Version version = record(day + 10 * minute, kept);
  archive.append(late);
  const Reproduction again = reproduce(archive, registry, version, {});
  EXPECT_FALSE(again.same_samples);
  EXPECT_FALSE(again.same_model);
  EXPECT_NE(again.model_digest, version.digest);
}

TEST_F(Provenance, OfAVersionWithoutOneIsRefused) {
  WindowCache kept = window_cache_of("SAT", plant());
  storage::Version version = record(day + 10 * minute, kept);
  version.provenance_json.clear();
  EXPECT_THROW(reproduce(archive, registry, version, {}), std::invalid_argument);
}

}  // namespace
}  // namespace reident::test::provenance_test
