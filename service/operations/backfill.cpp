#include "service/operations/backfill.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "service/operations/league_keeper.hpp"
#include "service/operations/refresh.hpp"
#include "service/support/floor_divide.hpp"
#include "service/windows/ticks.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {
namespace {

/// Windows that one thread works on in a row: what it keeps of one serves the next.
constexpr std::size_t windows_per_task = 4;

struct Plan {
  const std::string* spacecraft;
  EquipmentConfig equipment;        // with the phase of its ticks
  std::vector<storage::Time> ends;  // ascending
};

/// The window's ends without those that were tried.
std::vector<storage::Time> untried(const storage::Archive& archive,
                                   const storage::Registry& registry, const std::string& spacecraft,
                                   const EquipmentConfig& equipment, storage::TimeRange range) {
  std::vector<storage::Time> ends = window_ends(archive, spacecraft, equipment, range);
  storage::HistoryFilter filter;
  filter.spacecraft = spacecraft;
  filter.equipment = equipment.name;
  std::set<storage::Time> tried;
  for (const storage::Attempt& attempt : registry.attempts(filter))
    tried.insert(attempt.window.end);
  std::erase_if(ends, [&](storage::Time end) { return tried.contains(end); });
  return ends;
}

/// The file, open for reading, where it is not that of the database.
std::optional<storage::Database> other_than(const storage::Database& database,
                                            const std::filesystem::path& file) {
  if (std::filesystem::equivalent(database.path(), file)) return std::nullopt;
  return storage::Database(file, storage::Database::Mode::read_only);
}

/// Of the equipment of one database, one after the other.
class Backfill {
 public:
  Backfill(storage::Database& database, const Config& config, WorkerPool& workers,
           const std::function<storage::Time(storage::Time)>& clock,
           const std::function<bool(const BackfillProgress&)>& report)
      : config_(config),
        workers_(workers),
        clock_(clock),
        report_(report),
        other_(other_than(database, config.database)),
        archive_database_(other_ ? *other_ : database),
        archive_(archive_database_),
        registry_(database) {}

  BackfillProgress run(const BackfillRequest& request);

 private:
  // Those that return a bool: false when it was stopped.
  bool run(const Plan& plan);
  bool record(const RefreshRequest& request, PreparedWindow&& prepared, LeagueKeeper& league);
  /// Advances the league to the window's end, and tries the windows behind changes on the way.
  bool follow(const RefreshRequest& request, LeagueKeeper& league);
  bool attempt(RefreshRequest request, PreparedWindow&& prepared);
  std::optional<storage::TimeRange> advance(LeagueKeeper& league, const RefreshRequest& request,
                                            storage::Time reached);

  RefreshRequest request_of_window(const Plan& plan, storage::Time end) const;
  void prepare(const Plan& plan, std::size_t begin, std::size_t first,
               std::vector<std::optional<PreparedWindow>>& prepared);
  PreparedWindow prepare(const storage::Archive& archive, const RefreshRequest& request,
                         WindowCache& kept);
  PreparedWindow prepare(const RefreshRequest& request);
  identification::ForEach on_all_cores();

  const Config& config_;
  WorkerPool& workers_;
  const std::function<storage::Time(storage::Time)>& clock_;
  const std::function<bool(const BackfillProgress&)>& report_;
  std::function<std::optional<FoundWindow>(const RefreshRequest&)> found_;
  std::optional<storage::Database> other_;  // that telemetry is in
  storage::Database& archive_database_;
  storage::Archive archive_;
  storage::Registry registry_;
  /// Windows behind changes, by their ends, with their begins.
  std::map<storage::Time, storage::Time> behind_changes_;
  BackfillProgress progress_;
};

BackfillProgress Backfill::run(const BackfillRequest& request) {
  found_ = request.found;
  const storage::Registry beside_archive(archive_database_);
  std::vector<Plan> plans;
  for (const SpacecraftConfig& spacecraft : config_.spacecraft)
    for (const EquipmentConfig& equipment : spacecraft.equipment) {
      if (!request.spacecraft.empty() && spacecraft.name != request.spacecraft) continue;
      if (!request.equipment.empty() && equipment.name != request.equipment) continue;
      plans.push_back({&spacecraft.name,
                       with_phase(equipment, spacecraft.name, archive_, beside_archive),
                       untried(archive_, registry_, spacecraft.name, equipment, request.range)});
      progress_.windows += plans.back().ends.size();
    }
  for (const Plan& plan : plans)
    if (!run(plan)) break;
  return progress_;
}

bool Backfill::run(const Plan& plan) {
  progress_.equipment = *plan.spacecraft + "/" + plan.equipment.name;
  LeagueKeeper league(*plan.spacecraft, plan.equipment);
  behind_changes_.clear();
  const std::size_t batch = windows_per_task * usable_cores();
  for (std::size_t begin = 0; begin < plan.ends.size(); begin += batch) {
    const std::size_t end = std::min(plan.ends.size(), begin + batch);
    if (!other_) archive_.seal(*plan.spacecraft, plan.ends[end - 1]);
    std::vector<std::optional<PreparedWindow>> prepared(end - begin);
    workers_.for_each(
        (end - begin + windows_per_task - 1) / windows_per_task,
        [&](std::size_t task) { prepare(plan, begin, task * windows_per_task, prepared); });
    for (std::size_t i = 0; i < prepared.size(); ++i)
      if (!record(request_of_window(plan, plan.ends[begin + i]), std::move(*prepared[i]), league))
        return false;
  }
  return true;
}

RefreshRequest Backfill::request_of_window(const Plan& plan, storage::Time end) const {
  return {*plan.spacecraft,
          plan.equipment,
          {end - plan.equipment.window, end},
          "backfill",
          config_.digest};
}

identification::ForEach Backfill::on_all_cores() {
  return [this](std::size_t count, const std::function<void(std::size_t)>& task) {
    workers_.for_each(count, task);
  };
}

void Backfill::prepare(const Plan& plan, std::size_t begin, std::size_t first,
                       std::vector<std::optional<PreparedWindow>>& prepared) {
  storage::Database database(config_.database, storage::Database::Mode::read_only);
  const storage::Archive archive(database);
  WindowCache kept = window_cache_of(*plan.spacecraft, plan.equipment);
  for (std::size_t i = first; i < std::min(first + windows_per_task, prepared.size()); ++i)
    prepared[i] = prepare(archive, request_of_window(plan, plan.ends[begin + i]), kept);
}

PreparedWindow Backfill::prepare(const storage::Archive& archive, const RefreshRequest& request,
                                 WindowCache& kept) {
  if (const auto found = found_ ? found_(request) : std::nullopt)
    if (auto restored = restored_window(archive, request, kept, *found))
      return *std::move(restored);
  return prepare_window(archive, request, kept, on_all_cores(), [] { return false; });
}

PreparedWindow Backfill::prepare(const RefreshRequest& request) {
  WindowCache kept = window_cache_of(request.spacecraft, request.equipment);
  return prepare(archive_, request, kept);
}

bool Backfill::record(const RefreshRequest& request, PreparedWindow&& prepared,
                      LeagueKeeper& league) {
  return follow(request, league) && attempt(request, std::move(prepared)) &&
         follow(request, league);
}

bool Backfill::follow(const RefreshRequest& request, LeagueKeeper& league) {
  const storage::Time reached = request.window.end;
  for (;;) {
    const auto first = behind_changes_.begin();
    const bool is_first = first != behind_changes_.end() && first->first <= reached;
    if (const auto changed = advance(league, request, is_first ? first->first : reached)) {
      behind_changes_.emplace(changed->end, changed->begin);
      continue;
    }
    if (!is_first) return true;
    RefreshRequest behind = request;
    behind.window = {first->second, first->first};
    behind.trigger = "drift";
    behind_changes_.erase(first);
    ++progress_.windows;
    if (!attempt(behind, prepare(behind))) return false;
  }
}

bool Backfill::attempt(RefreshRequest request, PreparedWindow&& prepared) {
  const storage::TimeRange window =
      behind_champion(registry_, request.spacecraft, request.equipment.name, request.window);
  if (window.begin > request.window.begin) {  // it was prepared before the champion was known
    request.window = window;
    prepared = prepare(request);
  }
  RefreshResult result = judge(registry_, request, std::move(prepared));
  result.attempt.time = clock_(request.window.end);
  if (result.candidate)
    registry_.record(result.attempt, result.version, *result.decision);
  else
    registry_.record(result.attempt);
  ++progress_.done;
  progress_.window_end = request.window.end;
  return report_(progress_);
}

std::optional<storage::TimeRange> Backfill::advance(LeagueKeeper& league,
                                                    const RefreshRequest& request,
                                                    storage::Time reached) {
  LeagueWriter writer;
  writer.scores = [&](const auto& block, const auto& scores) {
    registry_.record_scores(request.spacecraft, request.equipment.name, block, scores);
  };
  writer.decide = [&](const storage::DecisionState& standing, const LeagueDecision& found) {
    const bool recorded = registry_
                              .decide_if(standing, request.spacecraft, request.equipment.name,
                                         found.version.number, found.decision, clock_(found.until))
                              .has_value();
    if (recorded && found.decision.kind == storage::DecisionKind::approve) ++progress_.approved;
    return recorded;
  };
  const storage::EquipmentName equipment{request.spacecraft, request.equipment.name};
  writer.failure = [&](const std::optional<Reason>& failure) {
    note_failure(registry_, equipment, failure, clock_(reached));
  };
  writer.change = [&](const storage::FoundChange& change) {
    registry_.record_change(equipment, change, clock_(change.found));
  };
  return league.advance(archive_, registry_, reached, writer);
}

}  // namespace

std::vector<storage::Time> window_ends(const storage::Archive& archive,
                                       const std::string& spacecraft,
                                       const EquipmentConfig& equipment, storage::TimeRange range) {
  std::set<storage::Time> ends;
  for (const std::string& name : parameters_of(equipment)) {
    const auto descriptor = archive.parameter(spacecraft, name);
    if (!descriptor) continue;
    const auto sample_at_or_after = [&](storage::Time time) {
      return archive.first_at_or_after(spacecraft, storage::Origin::real, descriptor->id, time);
    };
    const auto last =
        archive.last_at_or_before(spacecraft, storage::Origin::real, descriptor->id, range.end);
    for (auto sample = sample_at_or_after(range.begin - equipment.slide); sample && last;) {
      const storage::Time end = (floor_divide(*sample, equipment.slide) + 1) * equipment.slide;
      // Telemetry has to reach the end, as it does for the daemon.
      if (end > range.end || end > *last) break;
      if (end >= range.begin) ends.insert(end);
      sample = sample_at_or_after(end);
    }
  }
  return {ends.begin(), ends.end()};
}

BackfillProgress backfill(storage::Database& database, const Config& config,
                          const BackfillRequest& request, WorkerPool& workers,
                          const std::function<storage::Time(storage::Time)>& clock,
                          const std::function<bool(const BackfillProgress&)>& report) {
  return Backfill(database, config, workers, clock, report).run(request);
}

}  // namespace reident
