#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include "service/cli/output/stored_version.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/history/stored_readers.hpp"
#include "service/operations/commands.hpp"
#include "service/support/parallel.hpp"
#include "service/support/version.hpp"
#include "service/windows/provenance.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident::cli::reproduce_verb {
namespace {

using nlohmann::ordered_json;

struct Arguments {
  DatabaseOptions database;
  std::string subject;
  bool json = false;
};

std::string explanation(const Reproduction& again) {
  if (again.same_model && again.revisions > 0)
    return fmt::format(
        "the same model to the last bit, from the telemetry as it was then: {} late arrivals since "
        "are left out",
        again.revisions);
  if (again.same_model) return "the same model to the last bit";
  std::string text;
  if (!again.same_samples)
    text =
        "the telemetry of its window has changed since and it cannot be read as it was (samples "
        "removed, "
        "damaged, or brought by an older program)";
  else if (again.program_version != program_version())
    text = fmt::format("the samples are the same; program {} made it and this is {}",
                       again.program_version, program_version());
  else
    text = fmt::format(
        "the samples are the same and the model is not, though program {} made it, as this is: "
        "another build of {} made it, or else report it",
        again.program_version, again.program_version);
  if (again.model_digest.empty()) text += "; the window now gives no model: " + again.reason;
  return text;
}

void print(const StoredVersion& story, const Reproduction& again, bool json) {
  const storage::Version& version = story.version;
  if (json) {
    const ordered_json object = {{"spacecraft", version.spacecraft},
                                 {"equipment", version.equipment},
                                 {"version", version.number},
                                 {"same_samples", again.same_samples},
                                 {"same_model", again.same_model},
                                 {"late_arrivals_left_out", again.revisions},
                                 {"samples_digest", version.samples_digest},
                                 {"samples_digest_now", again.samples_digest},
                                 {"digest", version.digest},
                                 {"digest_now", again.model_digest},
                                 {"explanation", explanation(again)}};
    fmt::print("{}\n", object.dump(2));
    return;
  }
  fmt::print("{} version {}: {}\n", full_name({version.spacecraft, version.equipment}),
             version.number, explanation(again));
  fmt::print("samples {}, now {}\nmodel   {}, now {}\n", version.samples_digest,
             again.samples_digest, version.digest,
             again.model_digest.empty() ? "none" : again.model_digest);
}

int run(const Arguments& arguments) {
  const auto subject = parse_subject(arguments.subject);
  if (const auto* refusal = std::get_if<Refusal>(&subject)) return refuse(*refusal);
  return with_database(arguments.database, [&](storage::Database& database) {
    const auto found =
        find_stored_version(history::StoredHistory(database), std::get<Subject>(subject));
    if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
    const StoredVersion& story = std::get<StoredVersion>(found);
    WorkerPool workers(usable_cores());
    const auto on_all_cores = [&workers](std::size_t count,
                                         const std::function<void(std::size_t)>& task) {
      workers.for_each(count, task);
    };
    try {
      const Reproduction again = reproduce(storage::Archive(database), storage::Registry(database),
                                           story.version, on_all_cores);
      print(story, again, arguments.json);
      return static_cast<int>(again.same_model ? exit_done : exit_no_model);
    } catch (const std::invalid_argument& error) {
      return refuse({fmt::format("{} version {} cannot be identified again: {}",
                                 full_name({story.version.spacecraft, story.version.equipment}),
                                 story.version.number, error.what())});
    }
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_version_argument(command, arguments->subject);
  add_database_options(command, arguments->database);
  command.add_flag("--json", arguments->json, "one JSON object with the digests");
  command.footer(
      "Example:\n  reident reproduce CBERS-4/BDR@3 --config reident.toml\n"
      "Exit status: 0 for the same bits, 3 for another model or none.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"reproduce", "Identify a version again from the archive and compare it bit for bit",
     WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::reproduce_verb
