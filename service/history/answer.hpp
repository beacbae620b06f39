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

inline constexpr std::uint32_t max_page_rows = 10'000;

/// Why there are no rows: what is wrong with the question and what would mend it.
struct BadQuestion {
  std::string reason;
};

/// Throws storage::Error.
std::variant<HistoryPage, BadQuestion> answer(storage::Database& database,
                                              const HistoryQuery& query);

}  // namespace reident::history
