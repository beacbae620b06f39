// Scores the champion of an equipment on new telemetry, block by block, and finds when its errors
// have grown for good.
//
// A block is a sixteenth of the range that the champion was validated on, and as many rows as its
// initial state needs at least; that range's blocks are the reference
// (identification/statistics/change_detection.hpp). The free run goes on from block to block, as a
// simulator's does; after a gap its state is the one that agrees with the first telemetry behind.
// Excluded telemetry (telemetry_checks.hpp), checked together with the blocks before and those that
// came with it, is a gap: a faulty sensor is no drift of the champion.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "identification/simulation/square_changes.hpp"
#include "identification/statistics/change_detection.hpp"
#include "service/config/config.hpp"
#include "service/model/model_version.hpp"
#include "service/windows/window_cache.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

class ChampionMonitor {
 public:
  ChampionMonitor(std::string spacecraft, const EquipmentConfig& equipment);

  struct Drift {
    std::int64_t version = 0;
    storage::Time since = 0;  // end of the first block that raised the sum: it began in there
    storage::Time end = 0;    // of the block with which it was found
    double error_ratio = 0;   // of that block's error to the usual one
  };

  /// From which to identify what the equipment is since then: earlier telemetry shows nothing of
  /// that, so that the window begins with the drift, and it ends where that was found, or later,
  /// where half of the configured window, or what a window needs at least, lies behind its begin.
  static storage::TimeRange window_of(const Drift& drift, const EquipmentConfig& equipment);

  /// Takes in the blocks that telemetry up to `reached` completes. A champion that was replaced is
  /// forgotten. Of a champion that was validated in the past at most `most_past` before `reached`
  /// is looked at.
  std::optional<Drift> look(const storage::Archive& archive, const storage::Registry& registry,
                            storage::Time reached, Duration most_past);

 private:
  void watch(const storage::Archive& archive, const storage::Version& version);
  /// What is believed of the telemetry in `range`; absent where it is damaged.
  std::optional<identification::Record> believed(const storage::Archive& archive,
                                                 storage::TimeRange range);
  /// Runs the champion over a block of a record. Logarithm of its error there; absent where rows
  /// cover less than half of it. `changes` is the record's, taken at the first gap.
  std::optional<double> log_error(const identification::Record& record, storage::TimeRange block,
                                  std::optional<identification::SquareChanges>& changes);
  /// Outputs over a segment, from where the run is or, after a gap, from a new state.
  identification::Matrix run(const identification::Record& record,
                             const identification::Segment& segment,
                             std::optional<identification::SquareChanges>& changes);

  const std::string spacecraft_;
  const std::string equipment_;
  const Checks checks_;
  std::int64_t version_ = 0;  // that is watched; 0 before the first
  EquipmentModel model_;
  std::optional<WindowCache> telemetry_;  // of the newest blocks and of as many as the reference
  Duration block_ = 0;
  storage::Time next_ = 0;        // begin of the next block
  storage::Time since_ = 0;       // end of the last block that spoke against a drift
  identification::Vector state_;  // of the run, at the tick state_tick_
  std::optional<std::int64_t> state_tick_;
  identification::Vector square_errors_;  // of the run so far, summed over its rows
  identification::Index run_rows_ = 0;
  std::optional<identification::ChangeDetector> detector_;  // absent: nothing to compare with
};

}  // namespace reident
