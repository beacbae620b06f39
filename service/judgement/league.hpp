// The rule by which a version becomes champion: the conditions R1 to R5, from the records of the
// champion and of its challengers (service/DESIGN.md, "The gate"; METHOD.md 21 has the proof).
//
// A record is what a version's free run erred on each block of telemetry that nothing of it was
// fitted to. The functions are pure: equal records give equal findings.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "identification/statistics/betting.hpp"
#include "service/config/config.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

/// A version with its record.
struct Member {
  std::int64_t version = 0;
  storage::TimeRange window;
  std::vector<storage::BlockScore> scores;  // ascending
};

/// An equipment's versions and the telemetry of its blocks.
struct League {
  std::vector<storage::Block> blocks;  // ascending; all that a score is of are there
  std::optional<Member> champion;
  std::vector<Member> challengers;      // ascending by number
  std::vector<storage::TimeRange> admitted;  // windows of all that ever were challengers
  std::vector<std::string> unbound;     // parameters whose sensors no relation binds
  storage::Time champion_since = INT64_MIN;  // end of the telemetry that its approval rests on
};

/// A change of the equipment: the champion's errors have grown for good.
struct Change {
  storage::Time since = 0;  // it began behind here
  storage::Time found = 0;  // end of the block with which it was found
  double error_ratio = 0;   // of that block's error to the usual one
};

/// The last change in the champion's record; absent where there is none, or too little to compare
/// with.
std::optional<Change> change_of(const League& league);

/// Which condition speaks against a challenger, in the order in which they are looked at.
enum class Obstacle {
  none,
  not_admissible,   // R4
  not_better,       // R1
  within_margin,    // R1
  not_covered,      // R2
  worse_in_regime,  // R2
  bias_unverified,  // R3
  too_soon,         // R5
};

/// What the records say of a challenger.
struct Finding {
  std::int64_t version = 0;
  Obstacle obstacle = Obstacle::not_admissible;
  std::int64_t blocks = 0;         // compared
  double dependence = 1;           // identification::dependence
  double log_wealth = 0;           // of the bet that it is better
  double log_threshold = 0;        // that it has to reach
  double mean_score = 0;           // log of the champion's error over its own
  double lower_score = 0;          // lower end of the confidence sequence
  double mean_without_offset = 0;  // the same without the champion's mean error of each cycle
  double log_wealth_without_offset = 0;
  double uncovered_share = 0;  // of the champion's blocks, in regimes that it has not met
  double mrse_percent = 0;     // on the compared blocks
  double champion_mrse_percent = 0;
  double mean_mrse_percent = 0;      // of the mean of the outputs
  double baseline_mrse_percent = 0;  // of the simulator's own model; 0: it sent nothing
  double recent_score = 0;           // over the last two cycles
};

/// One finding for each challenger, in their order.
std::vector<Finding> judge(const League& league, const EquipmentConfig& limits);

/// The challenger that is to become champion; absent where none is.
std::optional<Finding> successor(const std::vector<Finding>& findings);

/// The challenger whose record says the most against it, which leaves a full league. Requires a
/// challenger.
Finding weakest(const std::vector<Finding>& findings);

}  // namespace reident
