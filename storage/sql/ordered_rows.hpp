// Rows of many series in one order.
//
// Series that the order puts side by side are merged by time, each read in blocks. Whatever their
// number, the blocks of those merged hold about `merged_rows` samples together (25 bytes each).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "storage/sql/plan.hpp"
#include "storage/sql/series_blocks.hpp"

namespace reident::storage::sql {

class OrderedRows {
 public:
  static constexpr std::size_t merged_rows = 1 << 20;

  /// `file` must outlive it.
  OrderedRows(ArchiveFile& file, Plan plan);
  OrderedRows(const OrderedRows&) = delete;  // readers point into it
  OrderedRows& operator=(const OrderedRows&) = delete;

  /// Rows [begin, end) of `columns`, not empty, that come next. Valid until the next call.
  struct Range {
    const SeriesName* series = nullptr;
    const SampleColumns* columns = nullptr;
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  std::optional<Range> next();

 private:
  struct Head {
    std::unique_ptr<SeriesBlocks> blocks;
    std::size_t row = 0;   // of the block
    std::size_t rank = 0;  // among rows of one time
    Time time() const { return blocks->block().time[row]; }
  };
  bool is_behind(const Head& a, const Head& b) const;
  void start_group();
  std::size_t end_of_range(const Head& head) const;

  ArchiveFile& file_;
  Plan plan_;
  std::vector<SeriesName> series_;  // in the order before time
  std::size_t started_ = 0;         // of them
  std::vector<Head> heap_;          // the one whose row comes next in front
  std::optional<Head> current_;     // out of the heap while its rows are in use
};

}  // namespace reident::storage::sql
