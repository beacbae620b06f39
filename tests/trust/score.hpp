// What the suite counts: wrong approvals, changes that were missed, and how long it took.
//
//   wrong approval  over the 30 orbits that follow its publication a version's MRSE on the truth is
//                   higher than that of what it replaced by more than a tenth and the sensors' own
//                   resolution
//   missed change   for more than 20 orbits of honest telemetry without a break the champion's MRSE
//                   on the truth is higher than 1.5 times an oracle's and the sensors' resolution
//                   above that
//
// README.md has the reasons for the figures. Errors are of free runs on the truth.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/satcs/reference/reference_life.hpp"
#include "tests/trust/truth.hpp"

namespace reident::trust {

inline constexpr std::int64_t judged_orbits = 30;
inline constexpr std::int64_t least_judged_orbits = 5;  // where a change cuts the 30 short
inline constexpr double worse_share = 0.10;
inline constexpr std::int64_t recovery_orbits = 20;
/// A change matters where the champion of then is bad over so many orbits.
inline constexpr std::int64_t mattering_orbits = 15;
inline constexpr double oracle_factor = 1.5;
/// Errors are compared over so many orbits: those of single ones differ by what was switched on.
inline constexpr std::int64_t smoothing_orbits = 5;
/// A change is followed for so long after it has grown.
inline constexpr std::int64_t followed_orbits = 45;

/// What simulators ran from a time on: a version, or, where there is none, the hand-written model.
struct Tenure {
  storage::Time since = 0;
  std::int64_t version = 0;  // 0: the hand-written model
  std::optional<EquipmentModel> model;
};

struct Publication {
  std::int64_t version = 0;
  storage::Time time = 0;
  storage::TimeRange judged_on;
  std::optional<double> mrse_percent;           // absent: too little was left to judge it
  std::optional<double> replaced_mrse_percent;  // of what it replaced
  double resolution_percent = 0;
  bool wrong() const;
  /// By how much it is worse than what it replaced, over the tolerance; above 1 it is wrong.
  double worse_over_tolerance() const;
};

struct ChangeScore {
  std::string kind;
  storage::Time begin = 0;
  bool mattered = false;    // the champion of then became worse than the factor allows
  std::int64_t orbits = 0;  // of honest telemetry, the longest range with a champion that was
  /// So many it would be with the best version of those that existed at each orbit: no rule that
  /// chooses among these versions has fewer.
  std::int64_t hindsight_orbits = 0;
  double worst_ratio = 0;  // of the champion's error to the oracle's
  ErrorCurve oracle;
  /// A version waits for an operator, since a sensor's bias may look like the change, within
  /// recovery_orbits after it has grown.
  bool is_asked = false;
  bool missed() const { return mattered && orbits > recovery_orbits; }
  bool missed_in_hindsight() const { return mattered && hindsight_orbits > recovery_orbits; }
};

/// A true change of the plant; those that begin together are one.
struct TrueChange {
  std::string kind;
  storage::Time begin = 0;
  storage::Time end = 0;  // of its growth
  bool is_step() const { return begin == end; }
};
std::vector<TrueChange> true_changes(const std::vector<satcs::reference::LifeEvent>& life);

/// Gives models by the time at which the window that they are identified from begins.
using Oracle = std::function<std::optional<EquipmentModel>(storage::Time begin)>;

/// Every version among `tenures`, which ascend and begin with the hand-written model.
std::vector<Publication> score_publications(const Truth& truth, const std::vector<Tenure>& tenures,
                                            const std::vector<TrueChange>& changes);

/// Error of what simulators ran, orbit by orbit.
ErrorCurve champion_curve(const Truth& truth, const std::vector<Tenure>& tenures);

/// Error of a version from when it was made, orbit by orbit.
struct VersionCurve {
  std::int64_t version = 0;
  storage::Time since = 0;
  ErrorCurve error;
};

/// Returns the curves of all versions with a model; `versions` has the times at which they were
/// made.
std::vector<VersionCurve> version_curves(const Truth& truth, const std::vector<Tenure>& versions);

/// Geometric mean, over the orbits with a champion, of the champion's error over the orbit and the
/// next 29, over the least one of any version that existed by then; errors below the sensors' own
/// resolution count as that. Absent without a champion.
std::optional<double> regret(const Truth& truth, const std::vector<Tenure>& tenures,
                             const std::vector<VersionCurve>& versions);

/// `honest` says whether an orbit's telemetry of the equipment is without faults that mislead.
std::vector<ChangeScore> score_changes(const Truth& truth, const std::vector<Tenure>& tenures,
                                       const std::vector<VersionCurve>& versions,
                                       const std::vector<TrueChange>& changes, const Oracle& oracle,
                                       const std::function<bool(storage::TimeRange)>& honest);

}  // namespace reident::trust
