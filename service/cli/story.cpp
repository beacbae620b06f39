#include "service/cli/story.hpp"

#include <utility>

#include <fmt/format.h>

#include "service/cli/stored.hpp"
#include "service/model/model_json.hpp"

namespace reident::cli {

using storage::Attempt;
using storage::Registry;

namespace {

std::string versions_text(const std::vector<Attempt>& attempts, const Registry& registry) {
  std::string text;
  for (const Attempt& attempt : attempts) {
    if (!attempt.version) continue;
    const auto version = registry.version(attempt.spacecraft, attempt.equipment, *attempt.version);
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", *attempt.version,
                        version ? version->status : "unknown");
  }
  return text.empty() ? "none yet" : text;
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
  }
  const std::size_t slash = rest.find('/');
  if (slash != std::string::npos) subject.spacecraft = rest.substr(0, slash);
  subject.equipment = slash == std::string::npos ? rest : rest.substr(slash + 1);
  if (subject.equipment.empty())
    return Refusal{fmt::format("{} names no equipment; write it as SPACECRAFT/EQUIPMENT", text)};
  return subject;
}

std::variant<Story, Refusal> find_story(const Registry& registry, const Subject& subject) {
  storage::HistoryFilter filter;
  filter.spacecraft = subject.spacecraft;
  filter.equipment = subject.equipment;
  const std::vector<Attempt> attempts = registry.attempts(filter);
  if (attempts.empty())
    return Refusal{fmt::format("nothing is known about {}; the database has {}",
                               subject.spacecraft.empty()
                                   ? subject.equipment
                                   : full_name(subject.spacecraft, subject.equipment),
                               equipment_in(registry))};
  const std::string& spacecraft = attempts.front().spacecraft;
  for (const Attempt& attempt : attempts)
    if (attempt.spacecraft != spacecraft)
      return Refusal{fmt::format("{} is on {} and on {}; name the spacecraft, as in {}",
                                 subject.equipment, spacecraft, attempt.spacecraft,
                                 full_name(spacecraft, subject.equipment))};
  auto version = subject.version ? registry.version(spacecraft, subject.equipment, *subject.version)
                                 : registry.champion(spacecraft, subject.equipment);
  const std::string name = full_name(spacecraft, subject.equipment);
  if (!version)
    return Refusal{subject.version
                       ? fmt::format("{} has no version {}; versions: {}", name, *subject.version,
                                     versions_text(attempts, registry))
                       : fmt::format("{} has no approved version; versions: {}", name,
                                     versions_text(attempts, registry))};
  Story story;
  for (const Attempt& attempt : attempts)
    if (attempt.id == version->attempt) story.attempt = attempt;
  story.decisions = registry.decisions(spacecraft, subject.equipment, version->number);
  story.hold = registry.hold(spacecraft, subject.equipment);
  story.model = equipment_model_from_json(version->model_json);
  story.digest_matches = model_digest(story.model) == version->digest;
  story.version = *std::move(version);
  return story;
}

std::optional<storage::TimeRange> tuned_on(const storage::Version& version) {
  const nlohmann::ordered_json provenance =
      nlohmann::ordered_json::parse(version.provenance_json, nullptr, false);
  const nlohmann::ordered_json::json_pointer tune("/parts/tune");
  if (!provenance.is_object() || !provenance.contains(tune)) return std::nullopt;
  const nlohmann::ordered_json& part = provenance[tune];
  const auto begin = part.find("begin_ns"), end = part.find("end_ns");
  if (begin == part.end() || end == part.end() || !begin->is_number_integer() ||
      !end->is_number_integer())
    return std::nullopt;
  return storage::TimeRange{begin->get<storage::Time>(), end->get<storage::Time>()};
}

}  // namespace reident::cli
