// The rule by which a version becomes champion: the conditions R1 to R5, from the records of the
// champion and of its challengers (service/DESIGN.md, "Gate"; identification/METHOD.md, section
// 19, has the proof).
//
// A record is what a version's free run erred on each block of telemetry that nothing of it was
// fitted to. Equal leagues give equal findings.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identification/statistics/operating_regimes.hpp"
#include "service/config/config.hpp"
#include "service/judgement/change.hpp"
#include "service/judgement/scores.hpp"
#include "service/model/reasons.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

/// An equipment's versions and the telemetry of its blocks.
struct League {
  std::vector<storage::Block> blocks;  // ascending; each that a score is of is there
  std::optional<Member> champion;
  storage::Time changed = INT64_MIN;  // `since` of the last change before the champion was made
  std::vector<Member> challengers;    // ascending by number
  /// The challenger that the champion replaced, if it is there, and the end of the telemetry by
  /// which that was decided: the bets on the two begin behind it.
  std::optional<std::int64_t> replaced;
  storage::Time replaced_at = INT64_MIN;
  std::vector<storage::TimeRange> admitted;  // windows of all that ever were challengers
  std::vector<std::string> unbound;          // parameters whose sensors no relation binds
  std::vector<std::string> outputs;
  std::vector<SensorBias> biases;  // of the inputs: BlockScore::bias_effects are of them
};

/// What the records say of a challenger. The conditions are looked at in the order R4, R1, R2, R3,
/// R5 until one does not hold; figures of those behind it are 0.
struct Finding {
  std::int64_t version = 0;
  std::optional<Reason> obstacle;  // absent where all conditions hold
  std::int64_t blocks = 0;         // compared
  double dependence = 1;           // identification::dependence
  double log_wealth = 0;           // of the bet that it is better
  double log_threshold = 0;        // that it has to reach
  double mean_score = 0;           // 1: it errs nothing beside the champion; -1: the reverse
  double lower_score = 0;          // lower end of the confidence sequence
  double uncovered_share = 0;      // of the blocks since `changed`, in regimes that it has not met
  /// Its error and the champion's over the regimes that the champion has served, with their shares
  /// of the time.
  std::pair<double, double> over_regimes_mrse_percent;
  /// Its error on telemetry from before `changed`, 0 without any, and what the change explains of
  /// it: the champion's there or since, whichever is larger, or the sum of both that a challenger
  /// errs, where that is less.
  std::pair<double, double> before_change_mrse_percent;
  double wealth_without_offset = 0;  // log, without what an offset of the likeliest sensor explains
  double mrse_without_offset = 0;    // the champion's [%], likewise
  double mrse_percent = 0;           // on the compared blocks
  double fit_percent = 0;            // the worst output's
  double champion_mrse_percent = 0;
  double baseline_mrse_percent = 0;   // of the simulator's own model; 0: it sent nothing
  storage::Time changed = INT64_MIN;  // `since` of the equipment's last change
  double recent_score = 0;            // over the last two cycles; a first version's: -MRSE [%]
};

/// The challenger that is to become champion; absent where none is.
std::optional<Finding> successor(const std::vector<Finding>& findings);

/// Whether the bet and the champion's `mrse` [%] are enough without what an offset explains (R3):
/// half of the gain, as a logarithm, or twice the version's error. What the offset explains may be
/// lost, and a version that has learnt it errs by it once the bias ends.
bool leaves_enough(const Finding& finding, double log_wealth, double mrse);

/// Whether R1 and R2 hold, so that it may become champion, or wait for an operator or for time.
bool is_proved(const Finding& finding);

/// The challenger with the least mean score, which leaves a full league: evidence grows with the
/// length of a record too, and those that came first would keep out all that come later. Those that
/// are proved stay where they are less than half: an operator finds the best of what waited for
/// him. Requires a challenger.
Finding weakest(const std::vector<Finding>& findings);

/// A block on which a challenger and the champion were compared.
struct ComparedBlock {
  storage::Time begin = 0;
  double score = 0;
  double mean = 0;   // of the scores so far
  double lower = 0;  // lower end of the confidence sequence so far
};

/// Judges a league. It may be asked again and again as records grow, and looks at what is new
/// alone; the answers are those of one that is asked once. `limits` must outlive it.
class Judge {
 public:
  explicit Judge(const EquipmentConfig& limits) : limits_(&limits) {}

  /// One finding for each challenger, in their order.
  std::vector<Finding> findings(const League& league);
  /// Begins of the blocks before the record of `member`, a new one, on which it has to run too:
  /// cycles of the operating regimes that the record does not have. Later versions are compared
  /// with it there. A first version runs on all of its window.
  std::vector<storage::Time> earlier_blocks(const League& league, const Member& member);
  /// The last change in the champion's record; absent where there is none, or too little to compare
  /// with.
  std::optional<Change> change(const League& league);
  /// Why the champion fails: since the last change it errs more than the mean of the outputs, or
  /// than the simulator's own model; with confidence, or by the margin on reference_blocks at
  /// least. Absent where it does not.
  std::optional<Reason> failure(const League& league);
  /// The blocks of which the finding about `challenger`, one of the league's, is made. Requires a
  /// champion.
  std::vector<ComparedBlock> compared_blocks(const League& league, const Member& challenger);

 private:
  /// What is known of the blocks since `since_`.
  struct Compared {
    Sums own;  // of the champion's record
    Comparison with_simulator;
    std::map<std::pair<std::int64_t, std::int64_t>, Comparison> pairs;  // by version, two members
    std::map<std::int64_t, double> dependence_before;  // by version, of blocks before `since_`
  };

  void take_in(const League& league);
  const Comparison& comparison(const League& league, const Member& one, const Member& other);
  storage::Time changed(const League& league) const;
  double usual_dependence(const League& league);
  double dependence_before(const League& league);

  const EquipmentConfig* limits_;
  std::optional<std::int64_t> champion_;  // that the rest is about
  identification::OperatingRegimes regimes_{blocks_of_cycle}, modes_{blocks_of_cycle};
  ChangeFinder change_, change_of_replaced_;
  storage::Time since_ = INT64_MIN;  // records count from here on
  std::size_t seen_ = 0;             // blocks that were looked at
  Compared compared_;
};

}  // namespace reident
