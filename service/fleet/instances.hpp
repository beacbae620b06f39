// How the instances of a machine are: what each one's database says, read side by side.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "service/history/overview_rows.hpp"
#include "service/support/parallel.hpp"

namespace reident::fleet {

/// One service's configuration, and how the models that it keeps are.
struct Instance {
  std::string name;        // of the file
  std::string problem;     // why nothing is known; empty else
  bool is_of_site = true;  // or never started, and in no table of the site
  /// Whether a process has the database open for writing; absent where nobody can say which.
  std::optional<bool> has_service{};
  std::vector<history::OverviewRow> rows;  // also of equipment that no window was tried of
  std::vector<storage::Alarm> alarms;
  std::string page;  // HOST:PORT of its operators' page, as the table has it; empty where none is

  std::size_t with_champion() const;  // equipment
  /// The generation time that the equipment farthest behind has reached.
  std::optional<storage::Time> oldest_telemetry() const;
  /// What is worst, in words; empty where all is well.
  std::string note() const;
  std::size_t unseen_alarms() const;
  std::size_t waiting() const;  // versions that wait for an operator
  /// Whether somebody has to act: any of the above, or no service. Never where it is not of the
  /// site.
  bool needs_action() const;
};

/// The instances whose configurations are `folder`/*.toml, the worst first. Tables of a site are
/// passed over. Where `reident fleet init` has made some of the configurations, another one without
/// a database, such as what they were made of, is not of the site. Throws std::invalid_argument
/// where there is none.
std::vector<Instance> read_instances(const std::filesystem::path& folder, WorkerPool& workers);

}  // namespace reident::fleet
