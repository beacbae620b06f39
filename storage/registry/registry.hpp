// Attempts, versions and decisions: what was tried, what came out, what was decided and why.
//
// Rows are only ever added. Every attempt at a window is recorded. An attempt that gave a model has
// a version; its number counts the versions of one equipment from 1. Every version has at least one
// decision. The champion of an equipment at a time is the version named by the last decision of
// kind `approve` or `roll_back` not later than it, unless that version was withdrawn by then; the
// last one is the one with the highest id, which also holds when the clock was set back. A
// version's parent is the champion that it was judged against; that one is still champion when it
// is approved.
//
// What changes a decision's ground (another decision, a hold) and the decision itself never cross:
// everything that decides checks its ground in the transaction that records it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "storage/database/database.hpp"
#include "storage/types/records.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

class Registry {
 public:
  /// The database must outlive the registry.
  explicit Registry(Database& database);

  /// An attempt that gave no model. Returns its id.
  std::int64_t record(const NewAttempt& attempt);
  /// An attempt, the next version of its equipment and the decision about it, in one transaction.
  /// Returns the version's number.
  std::int64_t record(const NewAttempt& attempt, const NewVersion& version,
                      const NewDecision& decision);
  /// The same, unless the equipment's standing is not the given one any more: then nothing is
  /// recorded and nothing returned.
  std::optional<std::int64_t> record_if(const Standing& standing, const NewAttempt& attempt,
                                        const NewVersion& version, const NewDecision& decision);
  /// One more decision about a version that exists. Throws Error where it does not follow from what
  /// was decided before: a waiting version is approved, if its parent is the champion, or rejected,
  /// a superseded one rolled back to, an approved or superseded one withdrawn. In the transaction
  /// that withdraws the champion, the previous champion, where there is one, is rolled back to.
  /// Returns the decision's id.
  std::int64_t decide(const std::string& spacecraft, const std::string& equipment,
                      std::int64_t version, const NewDecision& decision, Time time);

  /// The same by one who judged a waiting version against today's champion, whatever its parent was
  /// till then, unless the equipment's standing is not the given one any more.
  std::optional<std::int64_t> decide_if(const Standing& standing, const std::string& spacecraft,
                                        const std::string& equipment, std::int64_t version,
                                        const NewDecision& decision, Time time);

  /// Holds the equipment's champion, or releases it. Throws Error where it is held, or not held,
  /// already.
  void put_on_hold(const std::string& spacecraft, const std::string& equipment, const Hold& hold);
  void release(const std::string& spacecraft, const std::string& equipment, const Hold& release);

  /// Runs `effect`, which decides on this registry, and keeps the command with its outcome, in one
  /// transaction. A command whose outcome is kept already gets that, and its effect does not run
  /// again. Throws Error where the request's number was used for another command.
  CommandOutcome execute(const Command& command, Time time,
                         const std::function<CommandOutcome()>& effect);

  std::optional<Version> version(const std::string& spacecraft, const std::string& equipment,
                                 std::int64_t number) const;
  /// The champion now, or at `time`.
  std::optional<Version> champion(const std::string& spacecraft, const std::string& equipment,
                                  std::optional<Time> time = std::nullopt) const;
  /// The decision that made that champion; absent where there is none.
  std::optional<Decision> champion_decision(const std::string& spacecraft,
                                            const std::string& equipment,
                                            std::optional<Time> time = std::nullopt) const;
  /// The next one up the champion's line of parents that was not withdrawn.
  std::optional<Version> previous_champion(const std::string& spacecraft,
                                           const std::string& equipment) const;
  std::vector<Version> champions() const;
  /// Every version of an equipment, ascending.
  std::vector<VersionSummary> summaries(const std::string& spacecraft,
                                        const std::string& equipment) const;
  /// Versions of attempts with this outcome whose only decision is to wait, ascending.
  std::vector<std::int64_t> undecided(const std::string& spacecraft, const std::string& equipment,
                                      const std::string& outcome) const;
  /// Ascending by id.
  std::vector<Decision> decisions(const std::string& spacecraft, const std::string& equipment,
                                  std::optional<std::int64_t> version = std::nullopt) const;
  /// Those with attempts, in alphabetical order.
  std::vector<EquipmentName> equipment() const;
  std::optional<Hold> hold(const std::string& spacecraft, const std::string& equipment) const;
  /// Id of the last decision about any equipment, 0 before the first.
  std::int64_t last_decision() const;
  Standing standing(const std::string& spacecraft, const std::string& equipment) const;
  std::optional<Attempt> attempt(std::int64_t id) const;
  /// Ascending by id.
  std::vector<Attempt> attempts(const HistoryFilter& filter = {}) const;
  /// Calls `visit` with one row at a time, by id, until it answers false. The id of a version is
  /// that of its attempt.
  void each_attempt(const RowFilter& filter, const std::function<bool(Attempt&&)>& visit) const;
  void each_version(const RowFilter& filter, const std::function<bool(Version&&)>& visit) const;
  void each_decision(const RowFilter& filter, const std::function<bool(Decision&&)>& visit) const;
  /// End of the latest window that was tried for an equipment.
  std::optional<Time> last_window_end(const std::string& spacecraft,
                                      const std::string& equipment) const;

 private:
  Database& database_;
};

}  // namespace reident::storage
