#include "service/review/verdict.hpp"

#include <algorithm>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include "service/model/reasons.hpp"
#include "service/review/evidence.hpp"
#include "service/review/stored_league.hpp"

namespace reident {
namespace {

/// The figures of a decision of the league.
Finding finding_in(const nlohmann::ordered_json& evidence) {
  Finding finding;
  const auto read = [&evidence](const char* key, auto& value) {
    if (const auto found = evidence.find(key); found != evidence.end() && found->is_number())
      value = found->get<std::remove_reference_t<decltype(value)>>();
  };
  read("blocks", finding.blocks);
  read("log_wealth", finding.log_wealth);
  read("log_threshold", finding.log_threshold);
  read("lower_score", finding.lower_score);
  read("uncovered_share", finding.uncovered_share);
  read("over_regimes_mrse_percent", finding.over_regimes_mrse_percent.first);
  read("champion_over_regimes_mrse_percent", finding.over_regimes_mrse_percent.second);
  read("before_change_mrse_percent", finding.before_change_mrse_percent.first);
  read("champion_before_change_mrse_percent", finding.before_change_mrse_percent.second);
  read("log_wealth_without_offset", finding.wealth_without_offset);
  read("champion_mrse_without_offset_percent", finding.mrse_without_offset);
  read("mrse_percent", finding.mrse_percent);
  read("champion_mrse_percent", finding.champion_mrse_percent);
  read("fit_percent", finding.fit_percent);
  read("changed_ns", finding.changed);
  return finding;
}

/// What waits to replace the version that `approved`; empty where nothing does.
std::string waiting_text(const history::HistoryReader& history, const storage::Decision& approved) {
  std::size_t older = 0;
  std::int64_t newest = 0;
  for (const history::WaitingRow& row : history.waiting()) {
    if (row.decision.spacecraft != approved.spacecraft ||
        row.decision.equipment != approved.equipment)
      continue;
    older += newest > 0;
    newest = std::max(newest, row.decision.version);
  }
  if (newest == 0) return {};
  return fmt::format("Version {} waits for an operator's answer{}. ", newest,
                     older > 0 ? fmt::format(", as {} before it", older) : "");
}

}  // namespace

Verdict verdict_of(const history::HistoryReader& history, const StoredVersion& story) {
  const auto record = stored_record(history, story);
  if (record)
    if (auto finding = finding_now(*record, story)) {
      if (!finding->obstacle &&
          last_code(story.decisions.back()) == name(ReasonCode::waits_for_operator))
        finding->obstacle =
            because<ReasonCode::waits_for_operator>(finding->mrse_percent, finding->blocks);
      const std::string_view code = finding->obstacle ? name(finding->obstacle->code) : "";
      const bool asks = code == name(ReasonCode::waits_for_operator);  // its sentence says so
      return {finding->obstacle ? (asks ? "" : "Waits. ") + sentence(*finding->obstacle)
                                : "Waits, and all conditions on its record hold.",
              conditions_of(*finding, code, record->limits), std::move(finding)};
    }
  const storage::Decision& last = story.decisions.back();
  Verdict verdict{fmt::format("{} by {}{}{}", past(last.kind), last.actor,
                              last.reason.empty() ? "" : ": ", last.reason),
                  {},
                  {}};
  verdict.sentence.front() -= 'a' - 'A';
  for (auto one = story.decisions.rbegin(); record && one != story.decisions.rend(); ++one) {
    const nlohmann::ordered_json evidence = evidence_of(*one);
    if (!evidence.contains("log_threshold")) continue;
    const auto reasons = evidence.value("reasons", nlohmann::ordered_json::array());
    const std::string code = reasons.empty() ? "" : reasons.back().value("code", "");
    verdict.conditions = conditions_of(finding_in(evidence), code, record->limits);
    break;
  }
  if (story.version.status != "approved") return verdict;
  verdict.sentence = waiting_text(history, last) + verdict.sentence;
  if (const auto failure = failure_now(history, story.attempt, story.version.number))
    verdict.sentence = sentence(*failure) + " " + verdict.sentence;
  return verdict;
}

}  // namespace reident
