// The pages of each subject. Private to service/history.
#pragma once

#include "service/model/messages.hpp"
#include "storage/database/database.hpp"

namespace reident::history {

/// Each throws std::invalid_argument where the question cannot be answered, and storage::Error.
using AnswerSubject = HistoryPage (*)(storage::Database& database, const HistoryQuery& query);

HistoryPage equipment_page(storage::Database& database, const HistoryQuery& query);
HistoryPage attempts_page(storage::Database& database, const HistoryQuery& query);
HistoryPage versions_page(storage::Database& database, const HistoryQuery& query);
HistoryPage models_page(storage::Database& database, const HistoryQuery& query);
HistoryPage decisions_page(storage::Database& database, const HistoryQuery& query);
HistoryPage champions_page(storage::Database& database, const HistoryQuery& query);

HistoryPage parameters_page(storage::Database& database, const HistoryQuery& query);
HistoryPage series_page(storage::Database& database, const HistoryQuery& query);
HistoryPage sources_page(storage::Database& database, const HistoryQuery& query);
HistoryPage sequence_gaps_page(storage::Database& database, const HistoryQuery& query);
HistoryPage samples_page(storage::Database& database, const HistoryQuery& query);
HistoryPage completeness_page(storage::Database& database, const HistoryQuery& query);

}  // namespace reident::history
