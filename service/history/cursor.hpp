// Where a page ended, as an opaque text: the key of its last row, under a seal of the question that
// it belongs to. The next page has the rows beyond that key, so rows that were added meanwhile move
// nothing.
#pragma once

#include <optional>
#include <string>

#include "service/history/rows.hpp"
#include "service/model/messages.hpp"

namespace reident::history {

/// Returns the cursor of the page behind the row of this key. `key` is an array of integers and
/// texts; which, each subject decides for itself.
std::string cursor_after(const HistoryQuery& query, const Json& key);

/// Returns the key in the query's cursor; absent where the text is damaged or of another question.
/// The page size and the service that is asked are not part of the question. Requires a cursor that
/// is not empty. The seal finds mistakes, not forgery: a key may still be of another form.
std::optional<Json> key_of_cursor(const HistoryQuery& query);

}  // namespace reident::history
