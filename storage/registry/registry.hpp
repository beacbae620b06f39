// Attempts, versions and decisions: what was tried, what came out, what was decided and why.
//
// Rows are only ever added. Every attempt at a window is recorded. An attempt that gave a model has
// a version; its number counts the versions of one equipment from 1. Every version has at least one
// decision. The champion of an equipment at a time is the version named by the last decision of
// kind `approve` or `roll_back` not later than it, unless that version was withdrawn by then. The
// last one is the one with the highest id, which also holds when the clock was set back. A
// version's parent is the champion that it was judged against. A decision rests on what was decided
// before it (DecisionState): everything that decides checks this in its transaction.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "storage/database/database.hpp"
#include "storage/registry/journal.hpp"
#include "storage/types/registry_rows.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// The registry in a database; what is not const needs one that is opened for writing. Every
/// function may throw Error where the file or the disk refuses, and nothing is recorded then.
class Registry {
 public:
  /// The database must outlive the registry.
  explicit Registry(Database& database);

  /// Its rows in the order of their recording.
  Journal journal() const { return Journal(database_); }

  /// Records an attempt that gave no model. Returns its id.
  std::int64_t record(const NewAttempt& attempt);
  /// Records an attempt, the next version of its equipment and the decision about it, in one
  /// transaction. Returns the version's number.
  std::int64_t record(const NewAttempt& attempt, const NewVersion& version,
                      const NewDecision& decision);
  /// As record(), if the equipment's decision state is still the given one. Absent where it is not;
  /// then nothing is recorded.
  std::optional<std::int64_t> record_if(const DecisionState& state, const NewAttempt& attempt,
                                        const NewVersion& version, const NewDecision& decision);
  /// Records one more decision about a version that exists. A waiting version may be approved or
  /// rejected, or wait for another reason; a superseded one rolled back to; an approved or
  /// superseded one withdrawn. The transaction that withdraws the champion also rolls back to the
  /// previous champion, where there is one. Returns the decision's id. Throws Error (failed) for
  /// any other decision, and where the version does not exist.
  std::int64_t decide(const std::string& spacecraft, const std::string& equipment,
                      std::int64_t version, const NewDecision& decision, Time time);

  /// As decide(), if the equipment's decision state is still the given one. Absent where it is not;
  /// then nothing is recorded.
  std::optional<std::int64_t> decide_if(const DecisionState& state, const std::string& spacecraft,
                                        const std::string& equipment, std::int64_t version,
                                        const NewDecision& decision, Time time);

  /// Holds the equipment's champion, or releases it. Throws Error (failed) where it is held, or not
  /// held, already.
  void put_on_hold(const std::string& spacecraft, const std::string& equipment, const Hold& hold);
  void release(const std::string& spacecraft, const std::string& equipment, const Hold& release);

  /// Runs `effect`, which decides on this registry, and keeps the command with its outcome, in one
  /// transaction. Returns the outcome. A command whose outcome is kept already gets that, and its
  /// effect does not run again. Where the request's number was used for another command the outcome
  /// is not ok, and nothing is kept. What `effect` throws is thrown; then nothing is kept either.
  CommandOutcome execute(const Command& command, Time time,
                         const std::function<CommandOutcome()>& effect);
  /// The newest so many commands of the times in `range`, the newest first.
  std::vector<KeptCommand> commands(TimeRange range, std::size_t count) const;

  /// Adds a block, where one is given, and scores of versions on it or on earlier blocks, in one
  /// transaction. Throws Error (failed) where the block or a score is there already.
  void record_scores(const std::string& spacecraft, const std::string& equipment,
                     const std::optional<Block>& block, const std::vector<BlockScore>& scores);
  /// Blocks that begin at or behind `since`, ascending.
  std::vector<Block> blocks(const std::string& spacecraft, const std::string& equipment,
                            Time since) const;
  /// The newest so many blocks, ascending.
  std::vector<Block> newest_blocks(const EquipmentName& equipment, std::size_t count) const;
  /// End of the newest block; absent before the first.
  std::optional<Time> last_block_end(const std::string& spacecraft,
                                     const std::string& equipment) const;
  /// Scores of a version on blocks that begin at or behind `since`, ascending.
  std::vector<BlockScore> scores(const std::string& spacecraft, const std::string& equipment,
                                 std::int64_t version, Time since) const;

  /// Raises an alarm; one that is raised with the same text stays as it is, with another text it
  /// gets that one.
  void raise(const Alarm& alarm);
  /// Clears an alarm, if it is raised.
  void clear(const std::string& code, const EquipmentName& about, Time time);
  /// Notes who has seen an alarm. False where it is not raised.
  bool acknowledge(const std::string& code, const EquipmentName& about, const std::string& actor,
                   const std::string& reason, Time time);
  /// Alarms that are raised, by code, spacecraft and equipment.
  std::vector<Alarm> alarms() const;

  /// Adds a change, unless it is there.
  void record_change(const EquipmentName& equipment, const FoundChange& change, Time time);
  /// The change that was found last; absent where none was.
  std::optional<FoundChange> last_change(const EquipmentName& equipment) const;

  /// Adds what a simulator does now.
  void record_simulator(const SimulatorState& state);
  /// The simulators that are there, by name and equipment.
  std::vector<SimulatorState> simulators() const;

  /// A version with its model; absent where there is none of that number.
  std::optional<Version> version(const std::string& spacecraft, const std::string& equipment,
                                 std::int64_t number) const;
  /// The champion now, or at `time`; absent where there is none. Its status is that of now.
  std::optional<Version> champion(const std::string& spacecraft, const std::string& equipment,
                                  std::optional<Time> time = std::nullopt) const;
  /// The decision that made this champion; absent where there is none.
  std::optional<Decision> champion_decision(const std::string& spacecraft,
                                            const std::string& equipment,
                                            std::optional<Time> time = std::nullopt) const;
  /// The next version up the champion's line of parents that was not withdrawn; absent where there
  /// is none.
  std::optional<Version> previous_champion(const std::string& spacecraft,
                                           const std::string& equipment) const;
  /// The champions of all equipment, by spacecraft and equipment.
  std::vector<Version> champions() const;
  /// Every version of an equipment, ascending by number.
  std::vector<VersionSummary> summaries(const std::string& spacecraft,
                                        const std::string& equipment) const;
  /// Numbers of the waiting versions of attempts with this outcome, ascending: those that began to
  /// wait after the decision with the id `after`.
  std::vector<std::int64_t> waiting(const std::string& spacecraft, const std::string& equipment,
                                    const std::string& outcome, std::int64_t after = 0) const;
  /// The last decisions about waiting versions that say why these wait, by equipment and version.
  /// A decision of a program before version 0.2 has no evidence: it waits for an operator.
  std::vector<Decision> waits() const;
  /// Windows of all attempts with this outcome that gave a version, in the order of recording.
  std::vector<TimeRange> windows(const std::string& spacecraft, const std::string& equipment,
                                 const std::string& outcome) const;
  /// Decisions about an equipment, or one version of it, ascending by id.
  std::vector<Decision> decisions(const std::string& spacecraft, const std::string& equipment,
                                  std::optional<std::int64_t> version = std::nullopt) const;
  /// How much there is of an equipment.
  struct Counts {
    std::int64_t attempts = 0;
    std::int64_t versions = 0;
    std::int64_t approvals = 0;
  };
  Counts counts(const EquipmentName& equipment) const;
  /// Every equipment with attempts, in alphabetical order.
  std::vector<EquipmentName> equipment() const;
  /// The hold in force; absent where the champion is not held.
  std::optional<Hold> hold(const std::string& spacecraft, const std::string& equipment) const;
  /// Id of the last decision about any equipment, 0 before the first.
  std::int64_t last_decision() const;
  DecisionState decision_state(const std::string& spacecraft, const std::string& equipment) const;
  std::optional<Attempt> attempt(std::int64_t id) const;
  /// Attempts that the filter selects, ascending by id.
  std::vector<Attempt> attempts(const HistoryFilter& filter = {}) const;
  /// Calls `visit` with one row at a time, in the filter's order by id, until it answers false. The
  /// id of a version is that of its attempt.
  void each_attempt(const RowFilter& filter, const std::function<bool(Attempt&&)>& visit) const;
  void each_version(const RowFilter& filter, const std::function<bool(Version&&)>& visit) const;
  void each_decision(const RowFilter& filter, const std::function<bool(Decision&&)>& visit) const;
  /// End of the latest window that was tried for an equipment; absent where none was.
  std::optional<Time> last_window_end(const std::string& spacecraft,
                                      const std::string& equipment) const;

 private:
  Database& database_;
};

}  // namespace reident::storage
