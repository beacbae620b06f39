// What a refresh leaves of an equipment's window for the next one: its samples on the grid, and
// their sums. A window that slides reads and sums only what is new.
//
// Time is cut into chunks that do not depend on the window, so that what is kept gives the same
// bits as what is read again. What is excluded from a window depends on all of it: its holes are
// found again each time, and sums are kept as long as the holes in them stay the same.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/samples/tick_ranges.hpp"
#include "identification/subspace/lag_sums.hpp"
#include "service/windows/chunk_cache.hpp"
#include "service/windows/telemetry_checks.hpp"
#include "service/windows/window_data.hpp"
#include "storage/archive/archive.hpp"

namespace reident {

/// A part of a window whose whole is checked alone, and the biases of inputs' sensors whose effects
/// are wanted there (WindowData::bias_effects).
struct WantedPart {
  identification::TickRange ticks;
  std::vector<SensorBias> biases;
};

/// For one equipment and one thread at a time. An exception leaves it usable: what was not read is
/// read at the next load.
class WindowCache {
 public:
  /// `block_rows` as identification::block_rows_needed says. Reads nothing yet.
  WindowCache(const WindowRequest& request, identification::Index block_rows,
              const Checks& checks = {});

  const WindowRequest& request() const { return request_; }

  /// Returns load_window() without what the checks exclude; rows and coverage of the part alone
  /// where one is `wanted`. What lies before the window is forgotten: windows that go forward are
  /// the cheap ones. Throws storage::Error.
  std::variant<WindowData, UnknownParameter> load(const storage::Archive& archive,
                                                  storage::TimeRange window,
                                                  const std::optional<WantedPart>& wanted = {});

  /// Forgets the ticks that samples in `range` serve, since samples were stored there after the
  /// window was loaded.
  void forget(storage::TimeRange range);

  /// Sums over the rows that load() gave, for identify(). Valid until the next load().
  identification::LagSums& sums() { return sums_; }

  /// Ticks that load() has read from the archive so far.
  std::int64_t ticks_read() const { return ticks_read_; }

 private:
  /// Forgets the sums in which these holes differ from those that they were made with.
  void make_holes(const identification::TickSet& holes, identification::TickRange ticks);

  WindowRequest request_;
  PlausibilityChecks checks_;
  std::vector<Channel> channels_;  // that the chunks were read of
  ChunkCache samples_;             // u holds the input channels
  identification::LagSums sums_;
  identification::TickSet holes_;  // in the samples that the sums are of
  std::int64_t ticks_read_ = 0;
};

}  // namespace reident
