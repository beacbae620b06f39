// The verbs of `reident`. Each registers itself in one table, from which the help, the man page,
// the table of README.md and the refusals of --remote are made (verbs/help.cpp, main.cpp).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "service/cli/command.hpp"

namespace reident::cli {

/// In the order in which help lists them.
enum class WorksOn {
  history,   // what is stored: a database file or, with --remote, the running service
  decision,  // one equipment: through the running service, or on the file when none runs
  service,   // what runs now, over DDS alone
  database,  // the database file itself
  files,     // files that are named, or nothing
};

/// The heading of such verbs in help, man page and README.
std::string_view group_title(WorksOn works_on);

struct Verb {
  std::string_view name;
  std::string_view purpose;  // one line, beginning with a capital letter, without a full stop
  WorksOn works_on;
  /// Declares what the verb accepts on `command` (CLI11). Returns what the verb does once the
  /// arguments were read; that returns the exit status.
  std::function<std::function<int()>(CLI::App& command)> declare;
};

/// All verbs that are linked, by what they work on and then by name.
const std::vector<Verb>& verbs();

/// A static object of this type adds a verb to the table.
class VerbRegistration {
 public:
  explicit VerbRegistration(Verb verb);
};

/// Why a verb cannot have --remote: what it works on instead.
std::string why_not_remote(const Verb& verb);

}  // namespace reident::cli
