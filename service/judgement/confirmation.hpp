// Versions on probation: better than the champion by the margin, but on their windows' validation
// part alone not surely, or by little beside the sensors' noise, or mostly by a constant, or over
// less than a slow mode lasts, or in an unusual operation, or while nothing tells of a change.
// Telemetry that comes after their windows decides.
//
// The free runs of the version and of the champion, begun so long before the window that what they
// begin with is forgotten, go on over that telemetry, and are compared over the validation part and
// it together, over it alone, over all of the window too, where the champion errs hardly more than
// where it was validated, with what validated it too, and where it errs as it has before, or its
// slowest mode may be away for a while, with all that it has run on. A change of the equipment that
// is too new to fill the validation part is so followed sooner than by the next window, and a
// stretch of unusual operation is told from one.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/judgement/gate.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// What the validation part and telemetry after it show of a version.
struct ConfirmationEvidence {
  enum class Stage {
    early,  // more telemetry comes
    due,    // `confirmation` has passed, and telemetry of it has come
    last    // no more telemetry is waited for
  };
  Stage stage = Stage::early;
  storage::Time until = 0;  // end of the telemetry
  double fault_share = 0;   // of the window and what came after it (plausibility.hpp)
  std::int64_t champion = 0;
  double champion_validated_mrse_percent = 0;  // where it was validated
  double validated_mrse_percent = INFINITY;    // the version, where it was
  double slowest_rows = 0;                     // samples in the longer of their time constants
  Evidence::Comparison comparison;             // with the champion
  /// The same on what came after the window alone, by which nothing was chosen; without rows where
  /// nothing is left of it, or an output is 0 all over it.
  Evidence::Comparison after;
  /// The same with all of the window, to most of which the version was fitted.
  Evidence::Comparison with_window;
  /// The same on what validated the champion, before the version's window, and on all of this
  /// together. Looked at where the champion errs by less than the margin more than there; absent
  /// where less than half of that is left.
  std::optional<Evidence::Comparison> with_past{};
  /// The same on all that the champion has run on since it was validated, before the version's
  /// window and four windows back at most, and on what `comparison` is of. Looked at where the
  /// champion errs less than 1.5 times what it did in the worst stretch of then that is as long, or
  /// its error may be an excursion of its slowest mode, of a version that would be approved
  /// otherwise.
  std::optional<Evidence::Comparison> over_tenure{};
  double champion_worst_mrse_percent = 0;  // there; 0 where it did not run for so long
  Evidence::Comparison without_offset;     // `comparison` without the champion's mean error
  bool needs_vouching = false;             // a sensor that no relation binds could show that error
  /// Of the last telemetry, as many samples as the validation part has (run_comparison.hpp).
  double movement = 1;
  /// Input that stands still from the begin of the window on (the same).
  std::string still{};
  /// Share that is believed of the telemetry that the runs over the champion's tenure go through
  /// before the window, from where they are begun on.
  double tenure_believed = 1;
};

/// Approval or rejection; absent where more telemetry has to tell. An early look replaces only a
/// champion that was left behind, otherwise nothing hurries, and only by a version that is surely
/// better on what came after its window. From `due` on either of the two is enough, or that it is
/// so by a third of the margin over all of `with_past`: beside a champion that errs little more
/// than ever there is time to wait for that. What it gains has to show plainly beside the noise,
/// and at the last look to show; the noise itself is enough where the gain is surely above the
/// margin over all of the window too, and sure on what came after it, but not where the slowest
/// mode may be away for a while. A version that errs after its window twice what it did where it
/// was validated has to be surely better by all of the margin.
std::optional<storage::NewDecision> judge_probation(const ConfirmationEvidence& look,
                                                    const EquipmentConfig& limits);

/// The equipment's versions that wait for telemetry, ascending; none where an operator decides on
/// his own.
std::vector<storage::Version> on_probation(const storage::Registry& registry,
                                           const std::string& spacecraft,
                                           const EquipmentConfig& equipment);

/// So long before a version's window its runs and the champion's may begin, at most.
Duration longest_run_up(const EquipmentConfig& equipment);

struct ProbationDecision {
  storage::Version version;
  storage::NewDecision decision;
};

/// Records the decision if the decision state is still the given one. Whether it was recorded.
bool record(storage::Registry& registry, const storage::DecisionState& state,
            const ProbationDecision& found, storage::Time time);

using RecordProbation =
    std::function<bool(const storage::DecisionState&, const ProbationDecision&)>;

/// Looks at the equipment's versions on probation with telemetry until `reached`, that of the
/// newest window first: when it has gone on for three quarters and all of `confirmation`
/// behind the version's window, and, where that decides nothing or less than `min_coverage` of it
/// has come by then and is believed, once more when as long again has passed. Looks that
/// telemetry until `since` allowed are not repeated. A version whose window is older than the
/// champion's, or less than `min_interval` newer, is rejected, and one of which no telemetry is
/// left. Nothing is decided while an operator holds the equipment or decides on his own, nor from
/// telemetry that is damaged, but that a tenure which is damaged is not asked.
void look_at_probation(const storage::Archive& archive, const storage::Registry& registry,
                       const std::string& spacecraft, const EquipmentConfig& equipment,
                       storage::Time since, storage::Time reached, const RecordProbation& record);

}  // namespace reident
