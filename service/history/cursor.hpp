// Where a page ended, as an opaque text: the key of its last row, under a seal of the question that
// it belongs to. The next page has the rows beyond that key, so rows that were added meanwhile move
// nothing.
#pragma once

#include <optional>
#include <string>

#include "service/history/rows.hpp"
#include "service/model/messages.hpp"

namespace reident::history {

/// `key` is an array of integers and texts.
std::string cursor_after(const HistoryQuery& query, const Json& key);

/// The key in the query's cursor; absent where the text is damaged or of another question. The
/// cursor must not be empty.
std::optional<Json> key_of_cursor(const HistoryQuery& query);

}  // namespace reident::history
