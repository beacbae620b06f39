// One version of a model as an operator names it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "service/cli/command.hpp"
#include "service/cli/history_access.hpp"
#include "service/history/readers.hpp"
#include "service/review/stored_version.hpp"

namespace reident::cli {

/// SPACECRAFT/EQUIPMENT@VERSION taken apart; the spacecraft and the version may be left out.
struct Subject {
  std::string spacecraft;
  std::string equipment;
  std::optional<std::int64_t> version;
};

std::variant<Subject, Refusal> parse_subject(const std::string& text);

/// SPACECRAFT/EQUIPMENT taken apart; what is left out is empty, both where the text is. A text that
/// names a version is refused.
std::variant<storage::EquipmentName, Refusal> parse_equipment(const std::string& text);

/// All equipment that something is known about and that a text, as of parse_equipment(), means.
/// Refused where there is none.
std::variant<std::vector<storage::EquipmentName>, Refusal> find_equipment(
    const history::HistoryReader& history, const std::string& text);

/// The required first argument of a verb that is about one version.
void add_version_argument(CLI::App& command, std::string& subject);

/// The version that the subject names, or the champion of its equipment. A spacecraft that is left
/// out is found by the equipment's name.
std::variant<StoredVersion, Refusal> find_stored_version(const history::HistoryReader& history,
                                                         const Subject& subject);

/// Calls `work` with the version that `subject` names, and with the readers that it was found with.
/// Returns what that returns; a text that names no version, and a version that is not there, are
/// refused.
int with_version(const HistoryAccessOptions& options, const std::string& subject,
                 const std::function<int(const Readers&, StoredVersion&&)>& work);

}  // namespace reident::cli
