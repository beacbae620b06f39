#include "service/judgement/confirmation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "identification/simulation/free_run.hpp"
#include "service/judgement/run_comparison.hpp"
#include "service/model/model_json.hpp"
#include "service/windows/provenance.hpp"
#include "service/windows/window_cache.hpp"

namespace reident {
namespace {

using identification::RowRange;
using identification::Stationarity;
using nlohmann::ordered_json;
using storage::DecisionKind;
using storage::NewDecision;
using Code = ReasonCode;

/// Looks come when so many quarters of `confirmation` have passed since the window's end, the
/// newest one first: at 8 no telemetry is waited for any more. (By a look at 2 too some versions of
/// tests/trust were approved that erred more afterwards.)
constexpr std::array look_quarters = {8, 4, 3};

/// The newest look that telemetry until `reached` allows, where none until `since` did.
std::optional<storage::Time> look_time(const storage::Version& version,
                                       const EquipmentConfig& equipment, storage::Time since,
                                       storage::Time reached) {
  for (const int quarters : look_quarters) {
    const storage::Time time = version.window.end + equipment.confirmation * quarters / 4;
    if (time <= since) return std::nullopt;
    if (time <= reached) return time;
  }
  return std::nullopt;
}

NewDecision decision_of(DecisionKind kind, const std::vector<Reason>& reasons,
                        ordered_json evidence = {}) {
  evidence["reasons"] = to_json(reasons);
  return {kind, "gate", sentences(reasons),
          evidence.dump(-1, ' ', false, ordered_json::error_handler_t::replace)};
}

NewDecision rejection(Reason reason) {
  return decision_of(DecisionKind::reject, {std::move(reason)});
}

/// What was compared; of the champion's error also what counts, where a sensor that no relation
/// binds could show the rest.
Reason comparison_of(const ConfirmationEvidence& look) {
  const Evidence::Comparison& found = look.comparison;
  if (look.needs_vouching)
    return because<Code::evaluated_beside_offset>(found.mrse_percent, found.rows, look.until,
                                                  look.champion, found.rival_mrse_percent,
                                                  look.without_offset.rival_mrse_percent);
  return because<Code::evaluated>(found.mrse_percent, found.rows, look.until, look.champion,
                                  found.rival_mrse_percent);
}

NewDecision decision(DecisionKind kind, const ConfirmationEvidence& look, Reason reason) {
  ordered_json evidence = {
      {"until_ns", look.until},
      {"champion", look.champion},
      {"champion_validated_mrse_percent", look.champion_validated_mrse_percent},
      {"fault_share", look.fault_share},
      {"movement", look.movement},
      {"tenure_believed", look.tenure_believed},
      {"comparison", to_json(look.comparison)},
      {"after_window", to_json(look.after)},
      {"with_window", to_json(look.with_window)},
      {"without_offset", to_json(look.without_offset)},
      {"needs_vouching", look.needs_vouching},
      {"slowest_rows", look.slowest_rows}};
  if (!look.still.empty()) evidence["still"] = look.still;
  if (look.with_past) evidence["with_past"] = to_json(*look.with_past);
  if (look.champion_worst_mrse_percent > 0)
    evidence["champion_worst_mrse_percent"] = look.champion_worst_mrse_percent;
  if (look.over_tenure) evidence["over_tenure"] = to_json(*look.over_tenure);
  return decision_of(kind, {comparison_of(look), std::move(reason)}, std::move(evidence));
}

struct Reduction {
  double percent = 0;
  double sure_percent = 0;
};

/// The smaller one, where the champion's mean error has to be vouched for.
Reduction reduction_of(const ConfirmationEvidence& look) {
  const auto of = [](const Evidence::Comparison& comparison) -> Reduction {
    return {comparison.reduction_percent, comparison.sure_percent.value_or(-INFINITY)};
  };
  Reduction all = of(look.comparison);
  if (!look.needs_vouching) return all;
  const Reduction without = of(look.without_offset);
  return {std::min(all.percent, without.percent), std::min(all.sure_percent, without.sure_percent)};
}

/// In so many time constants little is left of the state that a mode was in: a twentieth.
constexpr int time_constants = 3;

/// Whether the champion may be right and its slowest mode away for a while: all that is surely
/// gained is a constant, the comparison is too short to see that mode return, and the champion has
/// not gone far beyond what it ever erred.
bool may_be_excursion(const ConfirmationEvidence& look, const EquipmentConfig& limits) {
  constexpr double far = 3;
  const double ever =
      std::max(look.champion_validated_mrse_percent, look.champion_worst_mrse_percent);
  return !(look.without_offset.sure_percent > surely_needed_elsewhere(limits)) &&
         static_cast<double>(look.comparison.rows) < time_constants * look.slowest_rows &&
         look.comparison.rival_mrse_percent < far * ever;
}

bool left_behind(const ConfirmationEvidence& look) {
  return is_left_behind(look.comparison.rival_mrse_percent, look.champion_validated_mrse_percent);
}

/// Whether it errs now as it did in the worst stretch of its tenure.
bool as_before(const ConfirmationEvidence& look) {
  return !is_left_behind(look.comparison.rival_mrse_percent, look.champion_worst_mrse_percent);
}

/// What speaks against the version of all that the champion has run on.
std::optional<Reason> against_tenure(const ConfirmationEvidence& look,
                                     const EquipmentConfig& limits) {
  constexpr double least_believed = 0.5;
  const double needed = surely_needed_elsewhere(limits);
  if (!left_behind(look) && look.tenure_believed < least_believed)
    return because<Code::unconfirmed_tenure_excluded>(look.champion_validated_mrse_percent,
                                                      100 * look.tenure_believed);
  if (const auto& all = look.over_tenure;
      all && as_before(look) && !(all->reduction_percent > needed))
    return because<Code::unconfirmed_as_in_tenure>(look.champion_worst_mrse_percent, all->rows,
                                                   all->mrse_percent, all->rival_mrse_percent);
  if (const auto& all = look.over_tenure;
      all && may_be_excursion(look, limits) &&
      !(all->sure_percent > needed &&
        static_cast<double>(all->rows) >= time_constants * look.slowest_rows))
    return because<Code::unconfirmed_excursion>(look.without_offset.rival_mrse_percent,
                                                look.slowest_rows, all->rows, all->mrse_percent,
                                                all->rival_mrse_percent);
  return std::nullopt;
}

/// Whether a sensor that no relation binds could show the champion's mean error, as the attempt
/// found.
bool needs_vouching(const storage::Registry& registry, const storage::Version& version,
                    const EquipmentConfig& limits) {
  if (limits.unvouched == UnvouchedPolicy::approve) return false;
  const auto attempt = registry.attempt(version.attempt);
  const auto evidence = nlohmann::json::parse(attempt->evidence_json, nullptr, false);
  if (!evidence.is_object()) return true;  // damaged
  return evidence.value("/champion/unbound"_json_pointer, nlohmann::json::array()).size() > 0;
}

/// For so long before the window free runs go on already, so that little is left of the states that
/// they begin with: three time constants of the slowest mode, longest_run_up at most.
Duration run_up(const EquipmentModel& model, const EquipmentModel& incumbent,
                const EquipmentConfig& equipment) {
  const double slowest = 1e9 * model.dynamics.period_s * slowest_rows(model, incumbent);
  return static_cast<Duration>(
      std::min(time_constants * slowest, static_cast<double>(longest_run_up(equipment))));
}

/// The two on what the champion has run on since it was validated until `end`, four windows at
/// most. Absent where that is nothing, none of it is left, or what is cannot be decoded.
std::optional<RunsOfBoth> runs_over_tenure(const storage::Archive& archive, storage::Time end,
                                           const EquipmentModel& model,
                                           const EquipmentModel& incumbent,
                                           const EquipmentConfig& equipment) {
  constexpr int windows = 4;
  const storage::TimeRange tenure{
      std::max(incumbent.validated_on.begin, end - windows * equipment.window), end};
  if (tenure.end <= tenure.begin) return std::nullopt;
  try {
    auto both = run_both(archive, model, incumbent, request_of(model), checks_of(equipment), tenure,
                         run_up(model, incumbent, equipment));
    if (both && both->runs.rows.empty()) return std::nullopt;
    return both;
  } catch (const storage::Error& error) {
    if (error.kind() != storage::Error::Kind::corrupt) throw;
    return std::nullopt;
  }
}

struct Looked {
  ConfirmationEvidence look;
  PairedRuns runs;  // what `look.comparison` is of
};

/// All but what the champion has run on. Absent where there is too little to compare on.
std::optional<Looked> longer_look(const storage::Archive& archive, storage::TimeRange window,
                                  const EquipmentModel& model, const EquipmentModel& incumbent,
                                  const EquipmentConfig& equipment, bool needs_vouching,
                                  storage::Time until) {
  ConfirmationEvidence look;
  look.until = until;
  const storage::TimeRange range{window.begin - run_up(model, incumbent, equipment), look.until};
  const WindowRequest request = request_of(model);
  const auto loaded = WindowCache(request, 1, checks_of(equipment)).load(archive, range);
  const auto* data = std::get_if<WindowData>(&loaded);
  if (!data) return std::nullopt;
  look.fault_share =
      fault_share(data->plausibility, ticks_of({window.begin, range.end}, request.period));
  const identification::Record& record = data->record;
  look.champion_validated_mrse_percent = incumbent.validation.mrse();
  look.validated_mrse_percent = model.validation.mrse();
  look.slowest_rows = slowest_rows(model, incumbent);
  look.needs_vouching = needs_vouching;
  const auto theirs = run_beside(archive, incumbent, request, record, range);
  if (!theirs) return std::nullopt;
  const identification::Matrix outputs = free_run(model.dynamics, record, record.all());
  const auto since = [&](storage::Time begin) {
    const std::int64_t first_tick = ticks_of({begin, range.end}, request.period).begin;
    return paired(record, {first_row_at(record, first_tick), record.rows()}, outputs, *theirs);
  };
  PairedRuns runs = since(model.validated_on.begin);
  if (runs.rows.empty()) return std::nullopt;
  look.comparison = compare(runs, equipment.confidence_percent, Stationarity::changing);
  const PairedRuns in_window = since(window.begin);
  look.with_window = compare(in_window, equipment.confidence_percent, Stationarity::changing);
  const PairedRuns after = since(window.end);
  if (!after.rows.empty() && (after.y.array() != 0).colwise().any().all())
    look.after = compare(after, equipment.confidence_percent, Stationarity::changing);
  if (same_inputs(incumbent, model)) {
    const Duration validation = model.validated_on.end - model.validated_on.begin;
    const auto last = std::min(std::ssize(runs.rows), validation / request.period);
    look.movement = movement(
        incumbent, record.u(std::vector(runs.rows.end() - last, runs.rows.end()), Eigen::all));
    look.still = still_input(archive, incumbent, record.u(in_window.rows, Eigen::all));
  }
  const auto ticks = static_cast<double>(equipment.confirmation / request.period);
  if (until >= window.end + equipment.confirmation && look.after.rows > 0 &&
      static_cast<double>(look.after.rows) >= equipment.min_coverage * ticks)
    look.stage = ConfirmationEvidence::Stage::due;
  if (until > window.end + equipment.confirmation) look.stage = ConfirmationEvidence::Stage::last;
  const double as_ever =
      look.champion_validated_mrse_percent * (1 + equipment.margin_percent / 100);
  if (look.comparison.rival_mrse_percent < as_ever)
    if (const auto past =
            runs_where_validated(archive, incumbent, model, checks_of(equipment), window.begin))
      look.with_past =
          compare(joined(*past, runs), equipment.confidence_percent, Stationarity::changing);
  PairedRuns centred = runs;
  centred.rival.rowwise() += (runs.y - runs.rival).colwise().mean();
  look.without_offset = compare(centred, equipment.confidence_percent, Stationarity::changing);
  return Looked{std::move(look), std::move(runs)};
}

void add_tenure(ConfirmationEvidence& look, const RunsOfBoth& tenure, const PairedRuns& runs,
                const EquipmentConfig& limits) {
  look.tenure_believed = tenure.believed_share;
  look.champion_worst_mrse_percent = worst_of_rival(tenure.runs, runs.y.rows());
  if (as_before(look) || may_be_excursion(look, limits))
    look.over_tenure =
        compare(joined(tenure.runs, runs), limits.confidence_percent, Stationarity::changing);
}

/// What speaks against the version whatever came after its window.
std::optional<NewDecision> against_window(const storage::Version& version,
                                          const std::optional<storage::Version>& champion,
                                          const EquipmentConfig& equipment) {
  if (!champion) return rejection(because<Code::unconfirmed_champion_withdrawn>());
  if (equipment.confirmation == 0) return rejection(because<Code::unconfirmed_confirmation_off>());
  const Duration newer = version.window.end - champion->window.end;
  if (newer < 0) return rejection(because<Code::unconfirmed_older>(champion->number));
  if (newer < equipment.min_interval)
    return rejection(
        because<Code::unconfirmed_too_soon>(newer, champion->number, equipment.min_interval));
  return std::nullopt;
}

std::optional<NewDecision> look_at(const storage::Archive& archive,
                                   const storage::Registry& registry,
                                   const EquipmentConfig& equipment,
                                   const storage::Version& version, storage::Time since,
                                   storage::Time reached) {
  const auto champion = registry.champion(version.spacecraft, version.equipment);
  if (auto refusal = against_window(version, champion, equipment)) return refusal;
  const auto time = look_time(version, equipment, since, reached);
  if (!time) return std::nullopt;
  for (const storage::Version* one : {&version, &*champion})
    if (const auto mistake = mistake_in(*one))
      return rejection(because<Code::unconfirmed_damaged>(one->number, *mistake));
  try {
    const EquipmentModel model = equipment_model_from_json(version.model_json);
    const EquipmentModel incumbent = equipment_model_from_json(champion->model_json);
    if (!same_outputs(model, incumbent))
      return rejection(because<Code::unconfirmed_other_outputs>(champion->number));
    const bool vouching = needs_vouching(registry, version, equipment);
    const storage::Time confirmed = version.window.end + equipment.confirmation;
    const auto judged = [&](storage::Time until) -> std::optional<NewDecision> {
      auto looked =
          longer_look(archive, version.window, model, incumbent, equipment, vouching, until);
      if (!looked) return std::nullopt;
      auto& [look, runs] = *looked;
      look.champion = champion->number;
      auto found = judge_probation(look, equipment);
      if (!found || found->kind != DecisionKind::approve) return found;
      // The champion's tenure, many times longer, can only speak against: it is read last.
      const auto tenure =
          runs_over_tenure(archive, version.window.begin, model, incumbent, equipment);
      if (!tenure) return found;
      add_tenure(look, *tenure, runs, equipment);
      return judge_probation(look, equipment);
    };
    if (since < confirmed)
      if (auto found = judged(std::min(*time, confirmed))) return found;
    if (*time <= confirmed) return std::nullopt;
    if (auto found = judged(*time)) return found;
    return rejection(because<Code::unconfirmed_nothing_left>());
  } catch (const storage::Error& error) {
    if (error.kind() != storage::Error::Kind::corrupt) throw;
    return std::nullopt;
  }
}

}  // namespace

std::optional<NewDecision> judge_probation(const ConfirmationEvidence& look,
                                           const EquipmentConfig& limits) {
  constexpr double most_growth = 2;
  const Reduction reduction = reduction_of(look);
  const bool keeps_up = look.after.mrse_percent < most_growth * look.validated_mrse_percent;
  const double needed = surely_needed_elsewhere(limits);
  const double surely_needed = keeps_up ? needed : limits.margin_percent;
  const auto against = [&]() -> std::optional<Reason> {
    if (is_in_doubt(look.fault_share))
      return because<Code::unconfirmed_in_doubt>(100 * look.fault_share);
    if (look.comparison.mrse_percent > limits.max_mrse_percent)
      return because<Code::unconfirmed_above_limit>(limits.max_mrse_percent);
    if (look.after.rows == 0) return because<Code::unconfirmed_nothing_after>();
    if (!(look.after.reduction_percent > 0))
      return because<Code::unconfirmed_worse_after>(look.after.rows, look.after.mrse_percent,
                                                    look.after.rival_mrse_percent);
    if (!(look.with_window.reduction_percent > 0))
      return because<Code::unconfirmed_worse_with_window>(look.with_window.mrse_percent,
                                                          look.with_window.rival_mrse_percent);
    if (!(reduction.percent > limits.margin_percent && reduction.sure_percent > surely_needed)) {
      if (keeps_up)
        return because<Code::unconfirmed_not_surely_less>(limits.margin_percent, surely_needed);
      return because<Code::unconfirmed_not_keeping_up>(limits.margin_percent, surely_needed,
                                                       look.after.mrse_percent,
                                                       look.validated_mrse_percent);
    }
    const bool surely_throughout = !may_be_excursion(look, limits) &&
                                   look.after.sure_percent > 0.0 &&
                                   look.with_window.sure_percent > limits.margin_percent;
    if (!shows_beside_noise(look.comparison,
                            surely_throughout ? lasting_gain_over_noise : least_gain_over_noise))
      return because<Code::unconfirmed_within_noise>(look.comparison.noise_percent);
    if (!look.still.empty()) return because<Code::unconfirmed_input_still>(look.still);
    if (is_unusual(look.movement)) return because<Code::unconfirmed_unusual>(100 * look.movement);
    if (const auto& both = look.with_past;
        both && !(both->reduction_percent > limits.margin_percent))
      return because<Code::unconfirmed_no_change>(look.champion_validated_mrse_percent, both->rows,
                                                  both->mrse_percent, both->rival_mrse_percent);
    return against_tenure(look, limits);
  }();
  using Stage = ConfirmationEvidence::Stage;
  const bool surely_after = look.after.sure_percent > 0.0;
  const bool surely_ever = look.with_past && look.with_past->sure_percent > needed;
  const bool suffices = look.stage == Stage::early
                            ? left_behind(look) && surely_after
                            : left_behind(look) || surely_after || surely_ever;
  const bool lasts_enough =
      look.stage == Stage::last || shows_beside_noise(look.comparison, plain_gain_over_noise);
  if (!against && suffices && lasts_enough)
    return decision(DecisionKind::approve, look,
                    because<Code::confirmed>(reduction.percent, limits.confidence_percent,
                                             reduction.sure_percent));
  if (look.stage == Stage::early || (look.stage == Stage::due && !against)) return std::nullopt;
  return decision(
      DecisionKind::reject, look,
      against ? *against
              : because<Code::unconfirmed_after_not_sure>(look.after.rows, look.after.mrse_percent,
                                                          look.after.rival_mrse_percent));
}

std::vector<storage::Version> on_probation(const storage::Registry& registry,
                                           const std::string& spacecraft,
                                           const EquipmentConfig& equipment) {
  std::vector<storage::Version> versions;
  if (equipment.approval != ApprovalPolicy::automatic) return versions;
  for (const std::int64_t number :
       registry.undecided(spacecraft, equipment.name, std::string(name(Outcome::on_probation))))
    versions.push_back(*registry.version(spacecraft, equipment.name, number));
  return versions;
}

Duration longest_run_up(const EquipmentConfig& equipment) {
  return time_constants * equipment.window;
}

bool record(storage::Registry& registry, const storage::DecisionState& state,
            const ProbationDecision& found, storage::Time time) {
  const storage::Version& version = found.version;
  return registry
      .decide_if(state, version.spacecraft, version.equipment, version.number, found.decision, time)
      .has_value();
}

void look_at_probation(const storage::Archive& archive, const storage::Registry& registry,
                       const std::string& spacecraft, const EquipmentConfig& equipment,
                       storage::Time since, storage::Time reached, const RecordProbation& record) {
  std::vector<storage::Version> versions = on_probation(registry, spacecraft, equipment);
  std::stable_sort(versions.begin(), versions.end(),
                   [](const auto& a, const auto& b) { return a.window.end > b.window.end; });
  for (const storage::Version& listed : versions) {
    const storage::DecisionState state = registry.decision_state(spacecraft, equipment.name);
    if (registry.hold(spacecraft, equipment.name)) return;
    storage::Version version = *registry.version(spacecraft, equipment.name, listed.number);
    if (version.status != "waiting") continue;  // another thread has decided meanwhile
    auto found = look_at(archive, registry, equipment, version, since, reached);
    if (found) record(state, {std::move(version), std::move(*found)});
  }
}

}  // namespace reident
