// One page while it is filled: bounded in rows and in bytes.
#pragma once

#include <optional>

#include "service/history/cursor.hpp"

namespace reident::history {

/// Bytes of rows in a page. A row that is larger alone is a page alone.
inline constexpr std::size_t page_bytes = std::size_t{256} << 10;

/// Takes the rows of one subject in the order of their keys until it is full. The query has to
/// outlive it.
class PageMaker {
 public:
  /// Throws std::invalid_argument where the query's cursor is not one of its own.
  explicit PageMaker(const HistoryQuery& query);

  /// The key of the last row before this page; absent for the first page. What is read begins
  /// behind it.
  const std::optional<Json>& beyond() const { return beyond_; }
  /// Adds a row, by whose key the next page would go on; false where the page is full without it.
  bool add(const Json& row, const Json& key);
  /// Returns the page; call once, when add() said false or no row is left. The page has a cursor
  /// where it said false.
  HistoryPage page();

 private:
  const HistoryQuery& query_;
  std::optional<Json> beyond_;
  HistoryPage page_;
  std::size_t bytes_ = 0;
  Json last_key_;
  bool is_cut_ = false;  // a row did not fit, so that another page follows
};

}  // namespace reident::history
