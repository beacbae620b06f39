// A registry in a folder of its own, and versions and decisions in few words.
#pragma once

#include "tests/storage/fixture.hpp"

namespace reident::storage::test {

using Mode = Database::Mode;

class RegistryTest : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  std::filesystem::path path = folder / "registry.db";
  Database database{path, Mode::read_write};
  Registry registry{database};

  static NewAttempt attempt(Time time, TimeRange window = {0, 100},
                            const std::string& equipment = "BDR") {
    return {.spacecraft = "CB4",
            .equipment = equipment,
            .window = window,
            .trigger = "slide",
            .time = time,
            .outcome = "error_above_limit",
            .reason = "MRSE 31 % is above the limit of 20 %",
            .evidence_json = R"({"mrse":31})",
            .configuration_digest = "c0ffee",
            .program_version = "0.1.0"};
  }
  static NewDecision decision(DecisionKind kind, const std::string& actor = "gate") {
    return {.kind = kind, .actor = actor, .reason = "because"};
  }
  std::int64_t version(Time time, DecisionKind kind, const std::string& equipment = "BDR") {
    return registry.record(attempt(time, {0, 100}, equipment),
                           {.model_json = "{\"time\":" + std::to_string(time) + "}",
                            .digest = "d" + std::to_string(time)},
                           decision(kind));
  }
  std::int64_t decide(std::int64_t version, DecisionKind kind, Time time) {
    return registry.decide("CB4", "BDR", version, decision(kind, "Ana"), time);
  }
  std::vector<std::string> statuses() const {
    std::vector<std::string> statuses;
    for (std::int64_t number = 1; registry.version("CB4", "BDR", number); ++number)
      statuses.push_back(registry.version("CB4", "BDR", number)->status);
    return statuses;
  }
  /// The champion's number at a time, or 0.
  std::int64_t champion_at(std::optional<Time> time) const {
    const auto champion = registry.champion("CB4", "BDR", time);
    return champion ? champion->number : 0;
  }
};

}  // namespace reident::storage::test
