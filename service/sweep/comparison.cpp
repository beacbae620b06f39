#include "service/sweep/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

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

/// The versions of one registry that simulators would have run, one after the other.
class ServedVersions {
 public:
  ServedVersions(storage::Database& database, const EquipmentName& equipment)
      : registry_(database),
        equipment_(equipment),
        tenures_(history::tenures(history::StoredHistory(database), equipment)) {}

  /// The error of the version of then; absent where there is none, or it cannot be run.
  std::optional<BlockScore> run(const BlockSamples& samples, const WindowRequest& request) {
    std::int64_t version = 0;
    for (const Tenure& one : tenures_)
      if (one.from <= samples.block.range.begin) version = one.version;
    if (version != version_) take(version, request);
    if (!model_) return std::nullopt;
    BlockScore score = score_block(*model_, version_, samples, state_);
    state_ = score.state;
    if (score.rows == 0 || !counts(samples.block)) return std::nullopt;
    sums_.add(samples.block, score.square);
    ++blocks_;
    return score;
  }

  ordered_json json(TimeRange range) const {
    ordered_json publications = ordered_json::array();
    for (const Tenure& one : tenures_)
      if (range.begin <= one.from && one.from <= range.end)
        publications.push_back({{"since_ns", one.from}, {"version", one.version}});
    return {{"publications", publications},
            {"blocks", blocks_},
            {"mrse_percent", percent(sums_)},
            {"regret", regret(range)}};
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
    if (request_of(model) == request)
      model_ = std::move(model);
    else
      note_ = fmt::format("version {} looks at other telemetry than the changed configuration",
                          version);
  }

  ordered_json regret(TimeRange range) const;

  const storage::Registry registry_;
  const EquipmentName equipment_;
  const std::vector<Tenure> tenures_;
  std::int64_t version_ = 0;
  std::optional<EquipmentModel> model_;
  storage::RunState state_;
  Sums sums_;
  std::size_t blocks_ = 0;
  std::string note_;
};

/// Errors of the versions over the blocks of one cycle, by version.
using CycleErrors = std::map<std::int64_t, Sums>;

ordered_json ServedVersions::regret(TimeRange range) const {
  const auto& [spacecraft, equipment] = equipment_;
  const std::vector<Block> blocks = registry_.blocks(spacecraft, equipment, range.begin);
  std::map<Time, std::size_t> cycle_of;  // by the begin of the block
  for (std::size_t i = 0; i < blocks.size(); ++i)
    cycle_of[blocks[i].range.begin] = i / blocks_of_cycle;
  std::vector<CycleErrors> cycles((blocks.size() + blocks_of_cycle - 1) / blocks_of_cycle);
  std::vector<double> rows(cycles.size(), 0);
  for (const Block& block : blocks)
    if (counts(block)) rows[cycle_of[block.range.begin]] += static_cast<double>(block.rows);
  for (const storage::VersionSummary& version : registry_.summaries(spacecraft, equipment))
    for (const BlockScore& score :
         registry_.scores(spacecraft, equipment, version.number, range.begin)) {
      const auto cycle = cycle_of.find(score.begin);
      if (cycle == cycle_of.end() || score.rows == 0) continue;
      const Block& block = *std::ranges::lower_bound(
          blocks, score.begin, {}, [](const Block& one) { return one.range.begin; });
      if (!counts(block)) continue;
      cycles[cycle->second][version.number].add(block, squares_of(score, score).one);
    }
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    std::int64_t champion = 0;
    for (const Tenure& one : tenures_)
      if (one.from <= blocks[i * blocks_of_cycle].range.begin) champion = one.version;
    const auto own = cycles[i].find(champion);
    if (own == cycles[i].end() || own->second.rows < rows[i]) continue;
    double least = own->second.mrse_percent();
    for (const auto& [version, errors] : cycles[i])
      if (errors.rows >= rows[i]) least = std::min(least, errors.mrse_percent());
    const double ratio = own->second.mrse_percent() / least;
    if (!std::isfinite(ratio)) continue;
    sum += std::log(ratio);
    ++count;
  }
  return count == 0 ? ordered_json() : ordered_json(std::exp(sum / static_cast<double>(count)));
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
  return {{"equipment", name.equipment},
          {"would", would.json(range)},
          {"was", was.json(range)},
          {"common",
           {{"blocks", common},
            {"would_mrse_percent", percent(would_common)},
            {"was_mrse_percent", percent(was_common)}}},
          {"outcomes", outcomes_of(sweep, name)},
          {"note", was.note()}};
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
