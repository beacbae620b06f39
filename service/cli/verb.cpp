#include "service/cli/verb.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include <fmt/format.h>

namespace reident::cli {
namespace {

std::vector<Verb>& table() {
  static std::vector<Verb> all;
  return all;
}

}  // namespace

std::string_view group_title(WorksOn works_on) {
  switch (works_on) {
    case WorksOn::history:
      return "Ask what is stored, in a file or with --remote";
    case WorksOn::decision:
      return "Decide about an equipment";
    case WorksOn::service:
      return "See what runs";
    case WorksOn::database:
      return "Work on the database file";
    case WorksOn::files:
      return "Work on other files";
  }
  return "";
}

const std::vector<Verb>& verbs() {
  return table();
}

VerbRegistration::VerbRegistration(Verb verb) {
  const auto later = [](const Verb& a, const Verb& b) {
    return std::tie(a.works_on, a.name) < std::tie(b.works_on, b.name);
  };
  table().insert(std::upper_bound(table().begin(), table().end(), verb, later), std::move(verb));
}

std::string why_not_remote(const Verb& verb) {
  if (verb.works_on == WorksOn::database)
    return fmt::format(
        "{} works on the database file itself: run it where that is, without --remote", verb.name);
  return fmt::format("{} is none of the commands that read a database; leave out --remote",
                     verb.name);
}

}  // namespace reident::cli
