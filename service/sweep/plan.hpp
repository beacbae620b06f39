// What a sweep consists of: a folder with changed configurations of one or more archives, and their
// windows cut into tasks that need nothing of each other.
//
//   plan.json             spacecraft, ranges of time and tasks; never changed
//   configuration-N.toml  as it would have been
//   archive-N.db          a copy of an archive, where one was asked for
//   candidates/N.json     what was found in the windows of task N
//   judged/NAME.db        the registry as it would be: attempts, versions, decisions
//   judged/NAME.json      what that came to, compared with what really was
//   failed/...            why a task failed; goes when it succeeds
//
// plan.json and the results are files of task_file.hpp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::sweep {

/// Windows of one equipment with ends in [range.begin, range.end].
struct CandidateTask {
  std::size_t spacecraft = 0;  // in Plan::spacecraft
  std::string equipment;
  storage::TimeRange range;
  std::size_t windows = 0;
};

struct PlannedSpacecraft {
  std::string name;
  std::size_t configuration = 0;  // in Plan::configurations
  storage::TimeRange range;       // of the windows' ends; telemetry reaches both
};

struct Plan {
  std::filesystem::path folder;
  std::string digest;           // SHA-256 of what it says; results name it
  std::string program_version;  // that makes all results
  std::vector<Config> configurations;
  std::vector<PlannedSpacecraft> spacecraft;
  std::vector<CandidateTask> candidates;

  std::filesystem::path file_of_candidates(std::size_t task) const;
  std::filesystem::path file_of_judgement(std::size_t spacecraft) const;
  std::filesystem::path registry_of(std::size_t spacecraft) const;
};

/// What is to be asked.
struct Question {
  std::vector<std::filesystem::path> configurations;
  std::vector<std::string> changes;  // ConfigChanges::equipment
  storage::TimeRange range;          // of the windows' ends
  bool copy = false;                 // of the archives, so that services may write meanwhile
};

/// Plans it in `folder`, which is made. Where the same was planned there, that plan stays; another
/// one is refused. `go_on` is asked while an archive is copied. Throws std::invalid_argument for a
/// question that cannot be met, storage::Error, and std::runtime_error where the folder cannot be
/// written.
Plan make_plan(const Question& question, const std::filesystem::path& folder,
               const std::function<bool()>& go_on);

/// Throws std::invalid_argument where there is no plan, or a configuration was changed since.
Plan read_plan(const std::filesystem::path& folder);

}  // namespace reident::sweep
