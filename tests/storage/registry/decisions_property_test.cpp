// Champions, statuses and parents against a plain list of what was decided.
#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "tests/storage/fixture.hpp"

namespace reident::storage::test::decisions_property_test {
namespace {

using enum DecisionKind;

/// The rules of SCHEMA.md, read off the list of decisions each time.
struct Ledger {
  struct Row {
    std::int64_t version;
    DecisionKind kind;
    Time time;
  };
  std::vector<Row> rows;
  std::int64_t versions = 0;

  static bool enthrones(DecisionKind kind) { return kind == approve || kind == roll_back; }

  /// Among the first so many rows, of those not later than `time`.
  std::int64_t champion(std::size_t among, std::optional<Time> time = std::nullopt) const {
    std::int64_t champion = 0;
    for (std::size_t i = 0; i < among; ++i)
      if (enthrones(rows[i].kind) && (!time || rows[i].time <= *time)) champion = rows[i].version;
    for (std::size_t i = 0; i < among; ++i)
      if (rows[i].kind == withdraw && rows[i].version == champion &&
          (!time || rows[i].time <= *time))
        return 0;
    return champion;
  }
  std::int64_t champion() const { return champion(rows.size()); }
  bool has(std::int64_t version, DecisionKind kind) const {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const Row& row) { return row.version == version && row.kind == kind; });
  }
  std::int64_t parent(std::int64_t version) const {
    std::optional<std::size_t> judged;
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (rows[i].version == version && (!judged || rows[i].kind == approve)) judged = i;
    return judged ? champion(*judged) : 0;
  }
  std::int64_t previous() const {
    std::int64_t version = champion();
    do version = version == 0 ? 0 : parent(version);
    while (version != 0 && has(version, withdraw));
    return version;
  }
  std::string status(std::int64_t version) const {
    if (has(version, withdraw)) return "withdrawn";
    if (champion() == version) return "approved";
    if (has(version, approve)) return "superseded";
    return has(version, reject) ? "rejected" : "waiting";
  }
  bool allows(std::int64_t version, DecisionKind kind) const {
    const std::string now = status(version);
    if (kind == approve || kind == reject || kind == wait) return now == "waiting";
    if (kind == roll_back) return now == "superseded";
    return kind == withdraw && (now == "approved" || now == "superseded");
  }
  void decide(std::int64_t version, DecisionKind kind, Time time) {
    const std::int64_t back = kind == withdraw && champion() == version ? previous() : 0;
    rows.push_back({version, kind, time});
    if (back != 0) rows.push_back({back, roll_back, time});
  }
};

void check(const Registry& registry, const Ledger& ledger) {
  const auto number = [](const auto& version) { return version ? version->number : 0; };
  RC_ASSERT(number(registry.champion("CB4", "BDR")) == ledger.champion());
  RC_ASSERT(number(registry.previous_champion("CB4", "BDR")) == ledger.previous());
  for (Time time = 0; time < 30; ++time)
    RC_ASSERT(number(registry.champion("CB4", "BDR", time)) ==
              ledger.champion(ledger.rows.size(), time));
  const std::vector<VersionSummary> summaries = registry.summaries("CB4", "BDR");
  RC_ASSERT(static_cast<std::int64_t>(summaries.size()) == ledger.versions);
  for (const VersionSummary& version : summaries) {
    RC_ASSERT(version.status == ledger.status(version.number));
    RC_ASSERT(version.parent.value_or(0) == ledger.parent(version.number));
  }
  const std::vector<Version> champions = registry.champions();
  RC_ASSERT(champions.size() == (ledger.champion() == 0 ? 0U : 1U));
}

RC_GTEST_PROP(DecisionsProperty, FollowTheRulesInWhateverOrderAndWhateverTheClock, ()) {
  const TemporaryFolder folder;
  Database database(folder / "a.db", Database::Mode::read_write);
  Registry registry(database);
  Ledger ledger;
  const auto steps = *rc::gen::inRange(1, 25);
  for (int step = 0; step < steps; ++step) {
    const Time time = *rc::gen::inRange<Time>(0, 30);  // the clock may be set back
    if (ledger.versions == 0 || *rc::gen::inRange(0, 3) == 0) {
      const DecisionKind first = *rc::gen::element(approve, approve, reject, wait, wait);
      NewAttempt attempt;
      attempt.spacecraft = "CB4";
      attempt.equipment = "BDR";
      attempt.time = time;
      RC_ASSERT(registry.record(attempt, {"{}", "d"}, {first, "gate", ""}) == ++ledger.versions);
      ledger.decide(ledger.versions, first, time);
      continue;
    }
    const auto version = *rc::gen::inRange<std::int64_t>(1, ledger.versions + 1);
    const DecisionKind kind = *rc::gen::element(approve, reject, wait, roll_back, withdraw);
    const bool by_gate = *rc::gen::inRange(0, 2) == 0;
    const bool allowed = ledger.allows(version, kind);
    const std::string error = error_of([&] {
      if (by_gate)
        registry.decide_if(registry.decision_state("CB4", "BDR"), "CB4", "BDR", version,
                           {kind, "gate", ""}, time);
      else
        registry.decide("CB4", "BDR", version, {kind, "Ana", ""}, time);
    });
    RC_ASSERT((error == "no error") == allowed);
    if (allowed) ledger.decide(version, kind, time);
  }
  check(registry, ledger);
  RC_ASSERT(registry.decisions("CB4", "BDR").size() == ledger.rows.size());
}

}  // namespace
}  // namespace reident::storage::test::decisions_property_test
