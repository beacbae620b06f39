// What a refresh leaves of an equipment's window for the next one: its samples on the grid, and
// their sums. A window that slides reads and sums only what is new.
//
// Time is cut into chunks that do not depend on the window, so that what is kept gives the same
// bits as what is read again.
#pragma once

#include <cstdint>
#include <map>
#include <variant>

#include "identification/lag_sums.hpp"
#include "identification/record.hpp"
#include "service/daemon/window_data.hpp"
#include "storage/archive.hpp"

namespace reident {

class KeptWindow {
 public:
  /// `block_rows` as identification::block_rows_needed says.
  KeptWindow(const WindowRequest& request, identification::Index block_rows);

  const WindowRequest& request() const { return request_; }

  /// The same as load_window; what lies before the window is forgotten.
  std::variant<WindowData, UnknownParameter> load(const storage::Archive& archive,
                                                  storage::TimeRange window);

  /// Samples in `range` were stored after the window was loaded.
  void forget(storage::TimeRange range);

  /// Of the rows that load() gave.
  identification::LagSums& sums() { return sums_; }

  /// Ticks that load() has read from the archive so far.
  std::int64_t ticks_read() const { return ticks_read_; }

 private:
  static constexpr std::int64_t chunk_ticks = 512;

  identification::TickRange ticks_of(storage::TimeRange range) const;
  /// Reads `ticks` and keeps the whole chunks of them.
  identification::Record read(const storage::Archive& archive, identification::TickRange ticks);

  WindowRequest request_;
  std::vector<std::uint32_t> parameters_;  // that the chunks were read of
  std::map<std::int64_t, identification::Record> chunks_;
  identification::LagSums sums_;
  std::int64_t ticks_read_ = 0;
};

}  // namespace reident
