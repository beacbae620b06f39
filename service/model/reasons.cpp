#include "service/model/reasons.hpp"

#include <iterator>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "service/support/time_text.hpp"

namespace reident {
namespace {

constexpr const OutcomeRow& row_of(Outcome outcome) {
  for (const OutcomeRow& row : Catalogue::outcomes)
    if (row.outcome == outcome) return row;
  throw std::logic_error("an outcome that the catalogue does not have");
}

/// Whether no two rows share a code or a name, and every outcome of a reason has a row.
constexpr bool is_consistent() {
  for (const OutcomeRow& row : Catalogue::outcomes)
    if (&row_of(row.outcome) != &row) return false;
  for (const ReasonRow& row : Catalogue::reasons) {
    if (&row_of(row.code) != &row) return false;
    if (row.outcome) row_of(*row.outcome);
    for (const ReasonRow* other = &row + 1; other != std::end(Catalogue::reasons); ++other)
      if (other->name == row.name) return false;
  }
  return true;
}
static_assert(is_consistent());

std::string text_of(const Figure& figure, std::string_view format) {
  if (format == "time") return time_text(std::get<std::int64_t>(figure));
  if (format == "duration") return duration_text(std::get<std::int64_t>(figure));
  const std::string place = fmt::format("{{:{}}}", format);
  return std::visit([&](const auto& value) { return fmt::format(fmt::runtime(place), value); },
                    figure);
}

}  // namespace

std::string_view name(Outcome outcome) {
  return row_of(outcome).name;
}

std::string_view name(ReasonCode code) {
  return row_of(code).name;
}

storage::DecisionKind kind_of(Outcome outcome) {
  if (const auto& kind = row_of(outcome).decision) return *kind;
  throw std::logic_error(fmt::format("the outcome {} gives no version", name(outcome)));
}

Outcome outcome_of(const std::vector<Reason>& reasons) {
  if (reasons.empty()) throw std::logic_error("an outcome without a reason");
  const ReasonRow& last = row_of(reasons.back().code);
  if (last.outcome) return *last.outcome;
  throw std::logic_error(fmt::format("the reason {} has no outcome", last.name));
}

std::string sentence(const Reason& reason) {
  const std::string_view pattern = row_of(reason.code).sentence;
  std::string text;
  std::size_t at = 0;
  for (const Figure& figure : reason.figures) {
    const auto place = next_figure(pattern, at);
    text += pattern.substr(at, place->begin - at);
    text += text_of(figure, place->format);
    at = place->end;
  }
  return text.append(pattern.substr(at));
}

std::string sentences(const std::vector<Reason>& reasons) {
  std::string text;
  for (const Reason& reason : reasons) text += (text.empty() ? "" : " ") + sentence(reason);
  return text;
}

nlohmann::ordered_json to_json(const std::vector<Reason>& reasons) {
  auto list = nlohmann::ordered_json::array();
  for (const Reason& reason : reasons) {
    nlohmann::ordered_json json = {{"code", name(reason.code)}};
    std::size_t at = 0;
    for (const Figure& figure : reason.figures) {
      const auto place = next_figure(row_of(reason.code).sentence, at);
      std::visit([&](const auto& value) { json[std::string(place->name)] = value; }, figure);
      at = place->end;
    }
    list.push_back(std::move(json));
  }
  return list;
}

std::string_view past(storage::DecisionKind kind) {
  switch (kind) {
    case storage::DecisionKind::approve:
      return "approved";
    case storage::DecisionKind::reject:
      return "rejected";
    case storage::DecisionKind::wait:
      return "left waiting";
    case storage::DecisionKind::roll_back:
      return "rolled back to";
    case storage::DecisionKind::withdraw:
      break;
  }
  return "withdrawn";
}

std::string last_code(const storage::Decision& decision) {
  const auto evidence = nlohmann::json::parse(decision.evidence_json, nullptr, false);
  if (!evidence.is_object() || !evidence.contains("reasons") || evidence["reasons"].empty())
    return {};
  return evidence["reasons"].back().value("code", "");
}

std::optional<storage::Time> changed_in(const storage::Decision& decision) {
  const auto evidence = nlohmann::json::parse(decision.evidence_json, nullptr, false);
  if (!evidence.is_object() || !evidence.contains("changed_ns")) return std::nullopt;
  const auto& changed = evidence["changed_ns"];
  return changed.is_number_integer() ? changed.get<storage::Time>() : INT64_MIN;
}

std::optional<storage::Time> judged_until(const storage::Decision& decision) {
  const auto evidence = nlohmann::json::parse(decision.evidence_json, nullptr, false);
  if (!evidence.is_object() || !evidence.contains("until_ns")) return std::nullopt;
  const auto& until = evidence["until_ns"];
  return until.is_number_integer() ? std::optional(until.get<storage::Time>()) : std::nullopt;
}

bool waits_for_operator(const storage::Decision& last) {
  if (last.kind != storage::DecisionKind::wait) return false;
  const std::string code = last_code(last);
  using enum ReasonCode;
  return code == name(waits_for_operator) || code == name(bias_unverified) || code == name(held);
}

}  // namespace reident
