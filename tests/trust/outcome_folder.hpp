// What became of scenarios, kept in files: a run of hours that was interrupted goes on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/trust/group_run.hpp"

namespace reident::trust {

class OutcomeFolder {
 public:
  /// Makes the folder where it does not exist.
  OutcomeFolder(std::filesystem::path folder, std::uint64_t draw, std::string keys = "");

  /// Absent where the scenario was not run yet. Throws std::runtime_error, which names the file,
  /// where it is damaged, or another program, draw or keys of equipment made it: figures of one run
  /// are of one of each.
  std::optional<ScenarioOutcome> find(const LifeGroup& group, const Scenario& scenario) const;

  /// Any thread may call it. Throws std::runtime_error where the file cannot be written.
  void keep(const ScenarioOutcome& outcome) const;

 private:
  std::filesystem::path file_of(int scenario) const;

  std::filesystem::path folder_;
  nlohmann::json made_by_;
};

}  // namespace reident::trust
