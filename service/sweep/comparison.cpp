#include "service/sweep/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "service/history/stored_readers.hpp"
#include "service/history/telemetry_champion.hpp"
#include "service/judgement/scores.hpp"
#include "service/model/model_json.hpp"
#include "service/support/floor_divide.hpp"
#include "service/support/sha256.hpp"
#include "service/windows/member_run.hpp"
#include "service/windows/provenance.hpp"
#include "service/windows/ticks.hpp"
#include "storage/archive/archive.hpp"

namespace reident::sweep {
namespace {

using history::Tenure;
using nlohmann::ordered_json;
using storage::Block;
using storage::BlockScore;
using storage::EquipmentName;
using storage::Time;
using storage::TimeRange;

ordered_json percent(const Sums& sums) {
  const double mrse = sums.mrse_percent();
  return sums.rows > 0 && std::isfinite(mrse) ? ordered_json(mrse) : ordered_json();
}

/// Logarithms of the champion's error over the least one, by the begin of the cycle.
using Regrets = std::map<Time, double>;

/// Mean over the cycles that `others` has too, as a ratio; null without one.
ordered_json geometric_mean(const Regrets& regrets, const Regrets& others) {
  double sum = 0;
  std::size_t count = 0;
  for (const auto& [begin, regret] : regrets) {
    if (!others.contains(begin)) continue;
    sum += regret;
    ++count;
  }
  return count == 0 ? ordered_json() : ordered_json(std::exp(sum / static_cast<double>(count)));
}

/// The versions of one registry that simulators would have run, one after the other.
class ServedVersions {
 public:
  ServedVersions(storage::Database& database, const EquipmentName& equipment)
      : registry_(database),
        equipment_(equipment),
        tenures_(history::tenures(history::StoredHistory(database), equipment)) {}

  /// 0 where there is none.
  std::int64_t version_at(Time time) const {
    std::int64_t version = 0;
    for (const Tenure& one : tenures_)
      if (one.from <= time) version = one.version;
    return version;
  }

  /// The error of the version of then; absent where there is none, or it cannot be run.
  std::optional<BlockScore> run(const BlockSamples& samples, const WindowRequest& request) {
    const std::int64_t version = version_at(samples.block.range.begin);
    if (version != version_) take(version, request);
    if (!model_) return std::nullopt;
    BlockScore score = score_block(*model_, version_, samples, state_);
    state_ = score.state;
    if (score.rows == 0 || !counts(samples.block)) return std::nullopt;
    sums_.add(samples.block, score.square);
    ++blocks_;
    return score;
  }

  /// Cycles are of this length and in the range. Call it behind run(), which tells what compares.
  Regrets regrets(TimeRange range, Duration cycle) const;

  ordered_json json(TimeRange range, const Regrets& regrets) const {
    ordered_json publications = ordered_json::array();
    for (std::size_t i = 0; i < tenures_.size(); ++i) {
      const bool ended = i + 1 < tenures_.size() && tenures_[i + 1].from <= range.begin;
      if (!ended && tenures_[i].from <= range.end)
        publications.push_back({{"since_ns", tenures_[i].from}, {"version", tenures_[i].version}});
    }
    return {{"publications", publications},
            {"blocks", blocks_},
            {"mrse_percent", percent(sums_)},
            {"regret", geometric_mean(regrets, regrets)}};
  }

  const std::string& note() const { return note_; }

 private:
  void take(std::int64_t version, const WindowRequest& request) {
    version_ = version;
    model_.reset();
    state_ = {};
    const auto stored = registry_.version(equipment_.spacecraft, equipment_.equipment, version);
    if (!stored) return;
    if (const auto mistake = mistake_in(*stored)) {
      note_ = fmt::format("version {}: {}", version, *mistake);
      return;
    }
    EquipmentModel model = equipment_model_from_json(stored->model_json);
    if (request_of(model) == request) {
      model_ = std::move(model);
      comparable_.insert(version);
    } else {
      note_ = fmt::format("version {} looks at other telemetry than the changed configuration",
                          version);
    }
  }

  const storage::Registry registry_;
  const EquipmentName equipment_;
  const std::vector<Tenure> tenures_;
  std::int64_t version_ = 0;
  std::optional<EquipmentModel> model_;
  storage::RunState state_;
  Sums sums_;
  std::size_t blocks_ = 0;
  std::set<std::int64_t> comparable_;  // of the telemetry of the changed configuration
  std::string note_;
};

Regrets ServedVersions::regrets(TimeRange range, Duration cycle) const {
  struct Cycle {
    Time first = 0;  // begin of its first block
    double rows = 0;
    std::map<std::int64_t, Sums> errors;  // by version
  };
  std::map<Time, Cycle> cycles;
  std::map<Time, Block> blocks;
  const auto cycle_of = [&](const Block& block) -> Cycle& {
    return cycles[floor_divide(block.range.begin, cycle) * cycle];
  };
  const auto& [spacecraft, equipment] = equipment_;
  for (const Block& block : registry_.blocks(spacecraft, equipment, range.begin)) {
    if (block.range.end > range.end || !counts(block)) continue;
    blocks[block.range.begin] = block;
    Cycle& one = cycle_of(block);
    if (one.rows == 0) one.first = block.range.begin;
    one.rows += static_cast<double>(block.rows);
  }
  for (const storage::VersionSummary& version : registry_.summaries(spacecraft, equipment)) {
    const auto stored = registry_.version(spacecraft, equipment, version.number);
    if (stored->window.end > range.end || mistake_in(*stored)) continue;
    const auto model = equipment_model_from_json(stored->model_json);
    const Time record = std::max(range.begin, model.validated_on.begin);
    for (const BlockScore& score :
         registry_.scores(spacecraft, equipment, version.number, record)) {
      const auto block = blocks.find(score.begin);
      if (block == blocks.end() || score.rows == 0) continue;
      std::vector<double> squares = score.square;
      for (std::size_t q = 0; q < squares.size(); ++q)
        squares[q] = std::max({squares[q], score.noise[q], least_square});
      cycle_of(block->second).errors[version.number].add(block->second, squares);
    }
  }
  Regrets regrets;
  for (const auto& [begin, one] : cycles) {
    const std::int64_t champion = version_at(one.first);
    const auto own = one.errors.find(champion);
    if (own == one.errors.end() || own->second.rows < one.rows || !comparable_.contains(champion))
      continue;
    double least = own->second.mrse_percent();
    for (const auto& [version, errors] : one.errors)
      if (errors.rows >= one.rows) least = std::min(least, errors.mrse_percent());
    const double regret = std::log(own->second.mrse_percent() / least);
    if (std::isfinite(regret)) regrets[begin] = regret;
  }
  return regrets;
}

/// What came of the windows of a sweep, the most frequent first.
std::string outcomes_of(storage::Database& sweep, const EquipmentName& equipment) {
  const storage::Registry registry(sweep);
  storage::HistoryFilter filter;
  filter.spacecraft = equipment.spacecraft;
  filter.equipment = equipment.equipment;
  std::map<std::string, std::size_t> counts;
  for (const storage::Attempt& attempt : registry.attempts(filter)) ++counts[attempt.outcome];
  if (counts.empty()) return "no window was tried";
  std::vector<std::pair<std::string, std::size_t>> sorted(counts.begin(), counts.end());
  std::ranges::stable_sort(sorted, std::ranges::greater(),
                           &std::pair<std::string, std::size_t>::second);
  std::string text;
  for (const auto& [outcome, count] : sorted)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, outcome);
  const auto decisions = registry.decisions(equipment.spacecraft, equipment.equipment);
  if (!decisions.empty()) text += "; last: " + decisions.back().reason;
  return text;
}

ordered_json compare_equipment(storage::Database& sweep, storage::Database& actual,
                               const EquipmentConfig& equipment, const EquipmentName& name,
                               TimeRange range) {
  const storage::Archive archive(actual);
  BlockReader reader(name.spacecraft,
                     with_phase(equipment, name.spacecraft, archive, storage::Registry(actual)));
  ServedVersions would(sweep, name), was(actual, name);
  Sums would_common, was_common;
  std::size_t common = 0;
  const Duration length = reader.length();
  for (Time begin = -floor_divide(-range.begin, length) * length; begin + length <= range.end;
       begin += length) {
    const BlockSamples samples = reader.read(archive, begin);
    const auto one = would.run(samples, reader.request());
    const auto other = was.run(samples, reader.request());
    if (!one || !other) continue;
    would_common.add(samples.block, one->square);
    was_common.add(samples.block, other->square);
    ++common;
  }
  std::string note = was.note();
  if (const std::int64_t version = was.version_at(range.begin); version != 0)
    note += fmt::format("{}version {} ran before; what would have been begins without it",
                        note.empty() ? "" : "; ", version);
  const Duration cycle = length * static_cast<Duration>(blocks_of_cycle);
  const Regrets would_regrets = would.regrets(range, cycle);
  const Regrets was_regrets = was.regrets(range, cycle);
  return {{"equipment", name.equipment},
          {"would", would.json(range, would_regrets)},
          {"was", was.json(range, was_regrets)},
          {"common",
           {{"blocks", common},
            {"would_mrse_percent", percent(would_common)},
            {"was_mrse_percent", percent(was_common)},
            {"would_regret", geometric_mean(would_regrets, was_regrets)},
            {"was_regret", geometric_mean(was_regrets, would_regrets)}}},
          {"outcomes", outcomes_of(sweep, name)},
          {"note", note}};
}

}  // namespace

ordered_json compare(storage::Database& sweep, const Config& config, const std::string& spacecraft,
                     TimeRange range) {
  storage::Database actual(config.database, storage::Database::Mode::read_only);
  ordered_json all = ordered_json::array();
  for (const SpacecraftConfig& one : config.spacecraft)
    if (one.name == spacecraft)
      for (const EquipmentConfig& equipment : one.equipment)
        all.push_back(
            compare_equipment(sweep, actual, equipment, {spacecraft, equipment.name}, range));
  return all;
}

std::string registry_digest(storage::Database& database) {
  const storage::Registry registry(database);
  std::string rows;  // digests of what there is, one after the other
  for (const storage::Attempt& attempt : registry.attempts()) {
    auto evidence = ordered_json::parse(attempt.evidence_json);
    evidence.erase("timing_ms");
    rows += sha256_hex(fmt::format("{} {} {} {} {} {} {}", attempt.spacecraft, attempt.equipment,
                                   attempt.window.begin, attempt.window.end, attempt.outcome,
                                   attempt.reason, evidence.dump()));
  }
  for (const EquipmentName& equipment : registry.equipment()) {
    for (const storage::VersionSummary& one :
         registry.summaries(equipment.spacecraft, equipment.equipment)) {
      const auto version = registry.version(equipment.spacecraft, equipment.equipment, one.number);
      rows += sha256_hex(fmt::format("{} {} {}", one.number, one.status, version->model_json));
      for (const BlockScore& score :
           registry.scores(equipment.spacecraft, equipment.equipment, one.number, INT64_MIN))
        rows += fmt::format("{} {} {} {};", score.begin, score.rows, fmt::join(score.square, " "),
                            fmt::join(score.mean, " "));
    }
    for (const storage::Decision& decision :
         registry.decisions(equipment.spacecraft, equipment.equipment))
      rows += sha256_hex(fmt::format("{} {} {} {} {} {}", decision.version,
                                     storage::name(decision.kind), decision.actor, decision.time,
                                     decision.reason, decision.evidence_json));
  }
  return sha256_hex(rows);
}

}  // namespace reident::sweep
