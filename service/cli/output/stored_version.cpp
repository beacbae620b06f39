#include "service/cli/output/stored_version.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "service/cli/stored.hpp"
#include "service/operations/commands.hpp"

namespace reident::cli {

using history::HistoryReader;

namespace {

std::string versions_text(const HistoryReader& history, const storage::EquipmentName& equipment) {
  constexpr std::size_t most = 5;
  const std::vector<storage::VersionSummary> versions = history.summaries(equipment);
  if (versions.empty()) return "none yet";
  std::string text = versions.size() > most
                         ? fmt::format("{} to {}, the last of them ", versions.front().number,
                                       versions.back().number)
                         : "";
  for (std::size_t i = versions.size() - std::min(most, versions.size()); i < versions.size(); ++i)
    text += fmt::format("{} ({}){}", versions[i].number, versions[i].status,
                        i + 1 < versions.size() ? ", " : "");
  return text;
}

/// The equipment that a subject means.
std::variant<storage::EquipmentName, Refusal> equipment_named(const HistoryReader& history,
                                                              const Subject& subject) {
  std::optional<storage::EquipmentName> found;
  for (const storage::EquipmentName& one : history.equipment()) {
    if (one.equipment != subject.equipment) continue;
    if (!subject.spacecraft.empty() && one.spacecraft != subject.spacecraft) continue;
    if (found)
      return Refusal{fmt::format("{} is on {} and on {}; name the spacecraft, as in {}",
                                 subject.equipment, found->spacecraft, one.spacecraft,
                                 full_name({found->spacecraft, subject.equipment}))};
    found = one;
  }
  if (found) return *found;
  return Refusal{fmt::format("nothing is known about {}; the database has {}",
                             subject.spacecraft.empty()
                                 ? subject.equipment
                                 : full_name({subject.spacecraft, subject.equipment}),
                             equipment_in(history))};
}

}  // namespace

std::variant<Subject, Refusal> parse_subject(const std::string& text) {
  Subject subject;
  std::string rest = text;
  if (const std::size_t at = rest.rfind('@'); at != std::string::npos) {
    subject.version = whole_number(rest.substr(at + 1));
    if (!subject.version || *subject.version < 1)
      return Refusal{fmt::format("{} names no version; write it as SPACECRAFT/EQUIPMENT@1", text)};
    rest.resize(at);
    if (const std::size_t other = rest.rfind('@');
        other != std::string::npos && whole_number(rest.substr(other + 1)))
      return Refusal{fmt::format("{} and {} are two versions; name one", rest.substr(other + 1),
                                 *subject.version)};
  }
  const std::size_t slash = rest.find('/');
  if (slash != std::string::npos) subject.spacecraft = rest.substr(0, slash);
  subject.equipment = slash == std::string::npos ? rest : rest.substr(slash + 1);
  if (subject.equipment.empty())
    return Refusal{fmt::format("{} names no equipment; write it as SPACECRAFT/EQUIPMENT", text)};
  return subject;
}

std::variant<storage::EquipmentName, Refusal> parse_equipment(const std::string& text) {
  if (text.empty()) return storage::EquipmentName{};
  const auto parsed = parse_subject(text);
  if (const auto* refusal = std::get_if<Refusal>(&parsed)) return *refusal;
  const Subject& subject = std::get<Subject>(parsed);
  if (subject.version) return Refusal{text + " names a version; name the equipment alone"};
  return storage::EquipmentName{subject.spacecraft, subject.equipment};
}

std::variant<std::vector<storage::EquipmentName>, Refusal> find_equipment(
    const HistoryReader& history, const std::string& text) {
  const auto parsed = parse_equipment(text);
  if (const auto* refusal = std::get_if<Refusal>(&parsed)) return *refusal;
  const auto& wanted = std::get<storage::EquipmentName>(parsed);
  std::vector<storage::EquipmentName> found;
  for (const storage::EquipmentName& one : history.equipment())
    if ((wanted.equipment.empty() || one.equipment == wanted.equipment) &&
        (wanted.spacecraft.empty() || one.spacecraft == wanted.spacecraft))
      found.push_back(one);
  if (!found.empty()) return found;
  return Refusal{fmt::format("nothing is known about {}; the database has {}",
                             text.empty() ? "any equipment" : text, equipment_in(history))};
}

void add_version_argument(CLI::App& command, std::string& subject) {
  command
      .add_option("subject", subject, "SPACECRAFT/EQUIPMENT@VERSION; without @VERSION the champion")
      ->required();
  command
      .add_option_function<std::string>(
          "version", [&subject](const std::string& number) { subject += "@" + number; },
          "the version's number, where @VERSION does not say it")
      ->check(above_zero());
}

std::variant<StoredVersion, Refusal> find_stored_version(const HistoryReader& history,
                                                         const Subject& subject) {
  const auto found = equipment_named(history, subject);
  if (const auto* refusal = std::get_if<Refusal>(&found)) return *refusal;
  const auto& equipment = std::get<storage::EquipmentName>(found);
  std::optional<std::int64_t> number = subject.version;
  if (!number)
    if (const auto made = history.champion_decision(equipment)) number = made->version;
  auto story = number ? stored_version(history, equipment, *number) : std::nullopt;
  if (story) return *std::move(story);
  const std::string name = full_name(equipment);
  const std::string versions = versions_text(history, equipment);
  if (subject.version)
    return Refusal{
        fmt::format("{} has no version {}; versions: {}", name, *subject.version, versions)};
  const bool has_any = !history.summaries(equipment).empty();
  return Refusal{fmt::format("{} has no approved version; versions: {}{}", name, versions,
                             has_any ? "; name one as " + name + "@NUMBER" : "")};
}

int with_version(const HistoryAccessOptions& options, const std::string& subject,
                 const std::function<int(const Readers&, StoredVersion&&)>& work) {
  const auto parsed = parse_subject(subject);
  if (const auto* refusal = std::get_if<Refusal>(&parsed)) return refuse(*refusal);
  return with_readers(options, [&](const Readers& readers) {
    auto found = find_stored_version(readers.history, std::get<Subject>(parsed));
    if (const auto* refusal = std::get_if<Refusal>(&found)) return refuse(*refusal);
    return work(readers, std::get<StoredVersion>(std::move(found)));
  });
}

}  // namespace reident::cli
