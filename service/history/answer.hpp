// The service's answer to one question: a page of rows from its database, or why there is none.
//
// The memory of an answer is that of a page and of one row, or of what one chunk of samples holds;
// idl/README.md, "History", has the subjects.
#pragma once

#include <string>
#include <variant>

#include "service/model/messages.hpp"
#include "storage/database/database.hpp"

namespace reident::history {

/// The largest page_size of a question.
inline constexpr std::uint32_t max_page_rows = 10'000;

/// Why there are no rows: what is wrong with the question and what would mend it.
struct BadQuestion {
  std::string reason;
};

/// Returns the page behind the query's cursor. A bad question is one of an unknown subject, with a
/// page size that is not 1 to max_page_rows, a range that ends before it begins, a bad name or
/// cursor, or about equipment that nobody knows. Telemetry that was never archived gives no rows.
/// Reads in a transaction of its own: pages are no snapshot. Throws storage::Error where the file
/// cannot be read or is damaged.
std::variant<HistoryPage, BadQuestion> answer(storage::Database& database,
                                              const HistoryQuery& query);

}  // namespace reident::history
