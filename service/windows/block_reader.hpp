// Telemetry of an equipment block by block, as versions are scored on it.
//
// A block is a quarter of the operating cycle, on a grid of time that starts at the epoch. What is
// excluded from a block follows from the telemetry of the blocks before it alone, so that the
// daemon and backfill read the same rows.
#pragma once

#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/windows/window_cache.hpp"
#include "storage/archive/archive.hpp"
#include "storage/types/registry_rows.hpp"

namespace reident {

/// The values as a row of the registry has them.
std::vector<double> list(const identification::Vector& values);

/// Blocks of an operating cycle.
inline constexpr int blocks_of_cycle = 4;

/// So many cycles show how things were: before a block what of it is not believed, before a window
/// the operating regimes that it lacks.
inline constexpr int cycles_before = 4;

/// Length of a block: a quarter of the cycle, in whole sample periods.
Duration block_length(const EquipmentConfig& equipment);

/// So long before a block begins the telemetry by which it is checked.
Duration checked_before_block(const EquipmentConfig& equipment);

/// The rows of a block and of the block before it, from which a run comes.
struct BlockSamples {
  storage::Block block;
  identification::Record record;
  identification::Index first_row = 0;  // of the block
  /// WindowData::bias_effects of biases_of() the inputs, at the record's rows.
  std::vector<identification::Record> bias_effects;
};

/// For one equipment and one thread at a time.
class BlockReader {
 public:
  BlockReader(const std::string& spacecraft, const EquipmentConfig& equipment);

  Duration length() const { return length_; }
  const WindowRequest& request() const { return telemetry_.request(); }

  /// Reads the block that begins at `begin`, a multiple of length(). Without rows where a parameter
  /// is not described, or samples are damaged. Not believed where no output has moved in all that
  /// is checked: a sensor may be stuck since before. Throws storage::Error where the file cannot be
  /// read.
  BlockSamples read(const storage::Archive& archive, storage::Time begin);

  /// Whether samples in `range` can change what read() gives of the block that begins at `begin`.
  bool reads(storage::Time begin, storage::TimeRange range) const;

  /// Forgets what samples in `range` serve, since samples were stored there.
  void forget(storage::TimeRange range) { telemetry_.forget(range); }

 private:
  /// Mean squared error of the simulator's own model; empty where it sent none.
  std::vector<double> baseline(const storage::Archive& archive, const BlockSamples& samples,
                               storage::TimeRange range) const;

  Duration length_;
  WindowCache telemetry_;
  std::vector<SensorBias> biases_;
};

}  // namespace reident
