#include "tests/trust/score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace reident::trust {
namespace {

using satcs::reference::LifeKind;

ErrorCurve run(const Truth& truth, const Tenure& tenure, storage::TimeRange range) {
  return tenure.model ? truth.free_run(*tenure.model, range) : truth.baseline(range);
}

std::optional<double> mrse_of(const ErrorCurve& curve) {
  return curve.mrse_percent(0, INT64_MAX);
}

/// Where the 30 orbits after a publication end: with the telemetry, or where the spacecraft is not
/// the same any more.
storage::Time judged_until(const Truth& truth, storage::Time since,
                           const std::vector<TrueChange>& changes, Duration orbit) {
  storage::Time until = std::min(truth.extent().end, since + judged_orbits * orbit);
  for (const TrueChange& change : changes)
    if (change.is_step() && change.begin > since) until = std::min(until, change.begin);
  return until;
}

const Tenure& at(const std::vector<Tenure>& tenures, storage::Time time) {
  const auto next = std::upper_bound(tenures.begin(), tenures.end(), time,
                                     [](storage::Time t, const Tenure& x) { return t < x.since; });
  return *std::prev(next);
}

/// The oracle's error over a change. While it grows, the model of the window before runs over each
/// window, which is the best that one who identifies without delay can have.
ErrorCurve oracle_curve(const Truth& truth, const TrueChange& change, storage::TimeRange followed,
                        const Oracle& oracle) {
  ErrorCurve curve = truth.empty_curve();
  const Duration window = truth.equipment().window;
  for (storage::Time begin = followed.begin; begin < followed.end;) {
    const bool growing = begin < change.end;
    const storage::Time end = growing ? std::min(followed.end, begin + window) : followed.end;
    const bool whole = begin + window <= truth.extent().end;
    if (const auto model = oracle(growing || !whole ? begin - window : begin))
      curve.add(truth.free_run(*model, {begin, end}));
    begin = end;
  }
  return curve;
}

/// Whether `error` is worse than the oracle's by more than the factor, over the smoothed orbits
/// from `block` on; absent where there is nothing to compare.
struct Comparison {
  bool bad = false;
  double ratio = 0;
};
std::optional<Comparison> compare(const ErrorCurve& error, const ErrorCurve& oracle,
                                  std::int64_t block, std::int64_t blocks, double resolution) {
  const auto mine = error.mrse_percent(block, block + blocks);
  const auto best = oracle.mrse_percent(block, block + blocks);
  if (!mine || !best) return std::nullopt;
  return Comparison{*mine > oracle_factor * *best + resolution, *mine / *best};
}

/// The longest range of bad orbits, of which only some count.
class BadOrbits {
 public:
  void add(bool is_bad, bool counts) {
    if (!is_bad) now_ = 0;
    now_ += is_bad && counts;
    longest_ = std::max(longest_, now_);
  }
  std::int64_t longest() const { return longest_; }

 private:
  std::int64_t now_ = 0;
  std::int64_t longest_ = 0;
};

}  // namespace

double Publication::worse_over_tolerance() const {
  if (!mrse_percent || !replaced_mrse_percent) return 0;
  return (*mrse_percent - *replaced_mrse_percent) /
         (worse_share * *replaced_mrse_percent + resolution_percent);
}

bool Publication::wrong() const {
  return worse_over_tolerance() > 1;
}

std::vector<TrueChange> true_changes(const std::vector<satcs::reference::LifeEvent>& life) {
  std::vector<TrueChange> changes;
  const auto add = [&changes](const TrueChange& change) {
    for (TrueChange& known : changes)
      if (known.begin == change.begin) {
        known.kind += "+" + change.kind;
        known.end = std::max(known.end, change.end);
        return;
      }
    changes.push_back(change);
  };
  for (const auto& event : life) {
    const std::string kind(name(event.kind));
    if (event.kind == LifeKind::safe_mode || event.kind == LifeKind::quiet) continue;
    const bool is_mode = event.end > event.begin && progress(event, event.begin) == 1;
    add({kind, event.begin, is_mode ? event.begin : event.end});
    if (is_mode) add({kind, event.end, event.end});
  }
  std::sort(changes.begin(), changes.end(),
            [](const TrueChange& a, const TrueChange& b) { return a.begin < b.begin; });
  return changes;
}

std::vector<Publication> score_publications(const Truth& truth, const std::vector<Tenure>& tenures,
                                            const std::vector<TrueChange>& changes) {
  std::vector<Publication> publications;
  const Duration orbit = truth.empty_curve().block();
  for (std::size_t i = 1; i < tenures.size(); ++i) {
    const Tenure& now = tenures[i];
    if (!now.model) continue;  // withdrawn: nobody publishes the hand-written model
    const storage::Time until = judged_until(truth, now.since, changes, orbit);
    Publication publication{.version = now.version,
                            .time = now.since,
                            .judged_on = {now.since, until},
                            .mrse_percent = {},
                            .replaced_mrse_percent = {}};
    if (until - now.since >= least_judged_orbits * orbit) {
      publication.mrse_percent = mrse_of(run(truth, now, publication.judged_on));
      publication.replaced_mrse_percent =
          mrse_of(run(truth, tenures[i - 1], publication.judged_on));
      publication.resolution_percent = truth.resolution_percent(publication.judged_on);
    }
    publications.push_back(publication);
  }
  return publications;
}

ErrorCurve champion_curve(const Truth& truth, const std::vector<Tenure>& tenures) {
  ErrorCurve curve = truth.empty_curve();
  for (std::size_t i = 0; i < tenures.size(); ++i) {
    const storage::Time until = i + 1 < tenures.size() ? tenures[i + 1].since : truth.extent().end;
    if (until > tenures[i].since) curve.add(run(truth, tenures[i], {tenures[i].since, until}));
  }
  return curve;
}

std::vector<VersionCurve> version_curves(const Truth& truth, const std::vector<Tenure>& versions) {
  std::vector<VersionCurve> curves;
  for (const auto& [since, version, model] : versions)
    if (model && since < truth.extent().end)
      curves.push_back({version, since, truth.free_run(*model, {since, truth.extent().end})});
  return curves;
}

std::optional<double> regret(const Truth& truth, const std::vector<Tenure>& tenures,
                             const std::vector<VersionCurve>& versions) {
  const ErrorCurve frame = truth.empty_curve();
  const double resolution = truth.resolution_percent(truth.extent());
  double sum = 0;
  std::int64_t orbits = 0;
  const std::int64_t last = frame.block_of(truth.extent().end) - least_judged_orbits;
  for (std::int64_t block = 0; block <= last; ++block) {
    const storage::Time now = frame.begin_of(block);
    const Tenure& champion = at(tenures, std::max(now, tenures.front().since));
    std::optional<double> own;
    double best = std::numeric_limits<double>::infinity();
    for (const VersionCurve& version : versions) {
      const bool runs = version.version == champion.version;
      if (!runs && version.since > now) continue;
      const auto mrse = version.error.mrse_percent(block, block + judged_orbits);
      if (!mrse) continue;
      const double error = std::max(*mrse, resolution);
      if (runs) own = error;
      best = std::min(best, error);
    }
    if (!own) continue;
    // A run that diverged is as bad as any: it counts as a hundred times the best.
    sum += std::log(std::min(*own / best, 100.0));
    ++orbits;
  }
  if (orbits == 0) return std::nullopt;
  return std::exp(sum / static_cast<double>(orbits));
}

std::vector<ChangeScore> score_changes(const Truth& truth, const std::vector<Tenure>& tenures,
                                       const std::vector<VersionCurve>& versions,
                                       const std::vector<TrueChange>& changes, const Oracle& oracle,
                                       const std::function<bool(storage::TimeRange)>& honest) {
  std::vector<ChangeScore> scores;
  const ErrorCurve champion = champion_curve(truth, tenures);
  const Duration orbit = champion.block();
  for (std::size_t i = 0; i < changes.size(); ++i) {
    const TrueChange& change = changes[i];
    const storage::Time next = i + 1 < changes.size() ? changes[i + 1].begin : INT64_MAX;
    const storage::TimeRange followed{
        change.begin, std::min({next, truth.extent().end, change.end + followed_orbits * orbit})};
    const ErrorCurve best = oracle_curve(truth, change, followed, oracle);
    const ErrorCurve old = run(truth, at(tenures, change.begin), followed);
    const double resolution = truth.resolution_percent(followed);
    ChangeScore score{.kind = change.kind, .begin = change.begin, .oracle = best};
    const auto is_bad = [&](const ErrorCurve& curve, std::int64_t block) {
      const auto it = compare(curve, best, block, smoothing_orbits, resolution);
      return !it || it->bad;
    };
    BadOrbits without_a_break;
    BadOrbits in_hindsight;
    // The first orbit of the change is half of the old spacecraft.
    for (std::int64_t block = champion.block_of(followed.begin) + 1;
         block + smoothing_orbits <= champion.block_of(followed.end); ++block) {
      if (const auto left = compare(old, best, block, mattering_orbits, resolution))
        score.mattered = score.mattered || left->bad;
      const auto now = compare(champion, best, block, smoothing_orbits, resolution);
      if (!now) continue;
      score.worst_ratio = std::max(score.worst_ratio, now->ratio);
      const storage::Time begin = champion.begin_of(block);
      const bool counts = honest({begin, begin + orbit});
      without_a_break.add(now->bad, counts);
      in_hindsight.add(now->bad && std::all_of(versions.begin(), versions.end(),
                                               [&](const VersionCurve& version) {
                                                 return version.since > begin ||
                                                        is_bad(version.error, block);
                                               }),
                       counts);
    }
    score.orbits = without_a_break.longest();
    score.hindsight_orbits = in_hindsight.longest();
    scores.push_back(score);
  }
  return scores;
}

}  // namespace reident::trust
