// Keeps the league of an equipment: scores its versions on each block of telemetry, and decides.
//
// The daemon and backfill both call it, as telemetry comes: the same telemetry and windows give the
// same scores to the last bit, and the same decisions.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "service/judgement/league.hpp"
#include "service/model/model_version.hpp"
#include "service/windows/block_reader.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// A decision of the rule about a version.
struct LeagueDecision {
  storage::Version version;
  storage::NewDecision decision;
  storage::Time until = 0;  // the telemetry that it is based on
};

/// How what was found gets into the registry, by whoever may write.
struct LeagueWriter {
  std::function<void(const std::optional<storage::Block>&, const std::vector<storage::BlockScore>&)>
      scores;
  /// Whether it was recorded: not where something was decided since `standing`.
  std::function<bool(const storage::DecisionState&, const LeagueDecision&)> decide;
  /// Called at the first look, when the champion begins to fail (Judge::failure()) and when none
  /// fails any more; may be empty.
  std::function<void(const std::optional<Reason>&)> failure{};
  /// Called with each change of the equipment that is found; may be empty.
  std::function<void(const storage::FoundChange&)> change{};
};

/// Raises the alarm of a champion that fails for this reason, or clears it.
void note_failure(storage::Registry& registry, const storage::EquipmentName& equipment,
                  const std::optional<Reason>& failure, storage::Time now);

/// For one equipment and one thread at a time. The configuration must outlive it.
class LeagueKeeper {
 public:
  LeagueKeeper(std::string spacecraft, const EquipmentConfig& equipment);

  /// Scores and decides on every block that telemetry until `reached` completes, oldest first, or
  /// until a change of the equipment is found: then it returns the window to identify from behind
  /// it. That begins with the change, and ends where it was found, or later, where half of the
  /// configured window, or what a window needs at least, lies behind its begin.
  std::optional<storage::TimeRange> advance(const storage::Archive& archive,
                                            const storage::Registry& registry,
                                            storage::Time reached, const LeagueWriter& writer);

  /// Forgets what samples in `range` served, since samples were stored there.
  void forget(storage::TimeRange range);

 private:
  /// What the last decision about a version says of its waiting.
  struct Waiting {
    bool for_operator = false;
    std::optional<std::string> code;  // absent where the decision is another one than to wait
  };

  /// Makes the members those of the registry now; what the registry has of them is read.
  void read_members(const storage::Registry& registry);
  const BlockSamples& samples_of(const storage::Archive& archive, storage::Time begin);
  /// Scores of the member on the blocks up to `end` that it has none of.
  void catch_up(const storage::Archive& archive, Member& member, storage::Time end,
                std::vector<storage::BlockScore>& scores);
  /// The run of a new member on telemetry before its record (Judge::earlier_blocks()).
  void run_earlier(const storage::Archive& archive, Member& member,
                   std::vector<storage::BlockScore>& scores);
  /// Decides what the records up to `now` say.
  void decide(const storage::Registry& registry, const LeagueWriter& writer, storage::Time now);
  bool decide(const storage::Registry& registry, const LeagueWriter& writer, const Finding& finding,
              storage::DecisionKind kind, const std::vector<Reason>& reasons, storage::Time now);
  /// Records that a waiting version waits for this reason now, unless it does already.
  void let_wait(const storage::Registry& registry, const LeagueWriter& writer,
                const Finding& finding, const Reason& reason, storage::Time now);
  void look_after_champion(const storage::Registry& registry, const LeagueWriter& writer, bool held,
                           storage::Time now);
  Reason why_better(const Finding& finding) const;

  const std::string spacecraft_;
  const EquipmentConfig& equipment_;
  BlockReader reader_;
  std::map<storage::Time, BlockSamples> samples_;          // of the newest blocks
  std::map<storage::Time, BlockSamples> earlier_samples_;  // that run_earlier() read last
  std::optional<storage::DecisionState> standing_;         // that the members are of
  League league_;
  std::vector<Relation> applying_;  // of the equipment's relations
  Judge judge_;
  std::map<std::int64_t, EquipmentModel> models_;  // of the members
  std::map<std::int64_t, Waiting> waiting_;        // of these
  std::optional<storage::Time> reached_;           // end of the last block
  std::optional<std::int64_t> failed_;             // champion that failed at the last look; 0: none
};

}  // namespace reident
