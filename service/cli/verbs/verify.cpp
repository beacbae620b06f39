#include "storage/care/verify.hpp"

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/cli/file_errors.hpp"
#include "service/cli/stored.hpp"
#include "service/cli/verb.hpp"
#include "service/support/output_file.hpp"
#include "service/support/progress.hpp"
#include "service/support/sha256.hpp"
#include "service/support/stop_signal.hpp"
#include "service/support/terminal.hpp"
#include "service/support/time_text.hpp"
#include "service/windows/provenance.hpp"

namespace reident::cli::verify_verb {
namespace {

using nlohmann::ordered_json;
using storage::Finding;
using storage::VerifyReport;

struct Arguments {
  DatabaseOptions database;
  std::string file;
  std::optional<std::string> known;
  bool quick = false;
  bool json = false;
};

std::string checked_end(const std::string& lines) {
  return "sha256 " + sha256_hex(lines) + "\n";
}

/// "V_BUS of CB4 (real), 2026-03-01T12:00:00Z to 2026-03-01T14:16:31Z"; empty for the whole file.
std::string where(const Finding& finding) {
  std::string text = finding.spacecraft.empty()
                         ? std::string()
                         : fmt::format("{} of {}", finding.name, finding.spacecraft);
  if (finding.origin) text += fmt::format(" ({})", storage::name(*finding.origin));
  if (finding.first && finding.last)
    text += fmt::format(", {} to {}", time_text(*finding.first), time_text(*finding.last));
  return text;
}

ordered_json to_json(const Finding& finding) {
  ordered_json object = {{"check", finding.check}};
  const auto text = [&](const char* key, const std::string& value) {
    object[key] = value.empty() ? ordered_json() : ordered_json(value);
  };
  const auto time = [&](const char* key, const std::optional<storage::Time>& value) {
    object[key] = value ? ordered_json(time_text(*value)) : ordered_json();
  };
  text("spacecraft", finding.spacecraft);
  text("name", finding.name);
  object["origin"] = finding.origin ? ordered_json(storage::name(*finding.origin)) : ordered_json();
  time("first", finding.first);
  time("last", finding.last);
  object["what"] = finding.what;
  object["remedy"] = finding.remedy;
  return object;
}

void print_json(const Arguments& arguments, const VerifyReport& report) {
  ordered_json findings = ordered_json::array();
  for (const Finding& finding : report.findings) findings.push_back(to_json(finding));
  const ordered_json object = {
      {"file", arguments.file},       {"sound", report.complete && report.found == 0},
      {"complete", report.complete},  {"quick", arguments.quick},
      {"series", report.series},      {"chunks", report.chunks},
      {"chunks_known", report.known}, {"samples", report.samples},
      {"versions", report.versions},  {"found", report.found},
      {"findings", findings}};
  fmt::print("{}\n", object.dump(2, ' ', false, ordered_json::error_handler_t::replace));
}

void print(const Arguments& arguments, const VerifyReport& report) {
  for (const Finding& finding : report.findings) {
    const std::string at = where(finding);
    fmt::print("{}: {}{}{}\n  remedy: {}\n", finding.check, at, at.empty() ? "" : ": ",
               finding.what, finding.remedy);
  }
  if (report.found > report.findings.size())
    fmt::print("and {} more\n", report.found - report.findings.size());
  const std::string result = report.found == 0   ? "sound"
                             : report.found == 1 ? "1 finding"
                                                 : fmt::format("{} findings", report.found);
  const std::string samples =
      arguments.quick
          ? ""
          : fmt::format(
                " with {} samples{}", report.samples,
                report.known == 0 ? "" : fmt::format(", {} more as they were", report.known));
  fmt::print("{}: {}; looked at {} series, {} chunks{} and {} versions{}\n", arguments.file,
             report.complete ? result : result + " so far, stopped", report.series, report.chunks,
             samples, report.versions, arguments.quick ? " quickly" : "");
}

/// What an earlier run found sound: a chunk a line, and the SHA-256 of the lines. Nothing where the
/// file is not there; where it is not whole that is printed, and every chunk is decoded.
storage::SoundChunks read_known(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return {};
  const std::string text(std::istreambuf_iterator<char>(stream), {});
  const std::size_t end = text.find("sha256 ");
  storage::SoundChunks chunks;
  if (end == std::string::npos || text.substr(end) != checked_end(text.substr(0, end))) {
    print_error("reident: {} is not whole: every chunk is decoded", file);
    return chunks;
  }
  std::istringstream lines(text.substr(0, end));
  std::int64_t data = 0;
  std::uint64_t digest = 0;
  while (lines >> data >> digest) chunks.emplace(data, digest);
  return chunks;
}

void write_known(const std::string& file, const storage::SoundChunks& chunks) {
  std::string text;
  for (const auto& [data, digest] : chunks) text += fmt::format("{} {}\n", data, digest);
  OutputFile output(file);
  output.write(text + checked_end(text));
  output.finish();
}

int run(Arguments& arguments) {
  const auto path = database_path(arguments.database);
  if (const auto* refusal = std::get_if<Refusal>(&path)) return refuse(*refusal);
  arguments.file = std::get<std::filesystem::path>(path).string();
  const StopSignal stop;
  return refusing_what_cannot_be([&] {
    storage::Database database(arguments.file, storage::Database::Mode::read_only);
    Progress bar;
    const storage::SoundChunks known =
        arguments.known ? read_known(*arguments.known) : storage::SoundChunks();
    const VerifyReport report =
        verify(database, {.quick = arguments.quick, .known = &known, .mistake_in = mistake_in},
               [&](const storage::VerifyProgress& progress) {
                 bar.update(progress.share, progress.at);
                 return !stop.token().stop_requested();
               });
    bar.clear();
    if (arguments.known && report.complete) write_known(*arguments.known, report.sound);
    if (arguments.json)
      print_json(arguments, report);
    else
      print(arguments, report);
    return report.complete && report.found == 0 ? exit_done : exit_failed;
  });
}

std::function<int()> declare(CLI::App& command) {
  const auto arguments = std::make_shared<Arguments>();
  add_file_argument(command, arguments->database, "database of the service, or a backup");
  CLI::Option* quick = command.add_flag("--quick", arguments->quick,
                                        "look at the summaries of chunks, and do not decode them");
  command
      .add_option("--known", arguments->known,
                  "file with what an earlier run found sound, made where missing: chunks whose "
                  "bytes are the same are not decoded again")
      ->excludes(quick);
  command.add_flag("--json", arguments->json, "one JSON object with the findings");
  command.footer(
      "Example:\n  reident verify reident.db --known reident.sound\n"
      "Exit status: 0 for a sound file, 1 where something was found or it was stopped, 2 where "
      "there is no such database.");
  return [arguments] { return run(*arguments); };
}

const VerbRegistration registered(
    {"verify", "Check every checksum and every invariant of a database, also while it is written",
     WorksOn::database, declare});

}  // namespace

}  // namespace reident::cli::verify_verb
