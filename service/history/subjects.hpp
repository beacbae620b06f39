// The pages of each subject. Private to service/history.
//
// A page function reads from behind the cursor's key until the page is full. What its rows ascend
// by, and which fields of the question select, is in idl/README.md, "History".
#pragma once

#include "service/model/messages.hpp"
#include "storage/database/database.hpp"

namespace reident::history {

/// Requires a question whose names, page size and range answer() has checked. Throws
/// std::invalid_argument, with the remedy, where it cannot be answered; nlohmann::json::exception
/// for a sealed cursor whose key is of another form; and storage::Error.
using AnswerSubject = HistoryPage (*)(storage::Database& database, const HistoryQuery& query);

// From the registry.
HistoryPage equipment_page(storage::Database& database, const HistoryQuery& query);
HistoryPage attempts_page(storage::Database& database, const HistoryQuery& query);
HistoryPage versions_page(storage::Database& database, const HistoryQuery& query);
HistoryPage models_page(storage::Database& database, const HistoryQuery& query);
HistoryPage decisions_page(storage::Database& database, const HistoryQuery& query);
HistoryPage champions_page(storage::Database& database, const HistoryQuery& query);
// How things are now, of the equipment that is selected.
HistoryPage overview_page(storage::Database& database, const HistoryQuery& query);
HistoryPage waiting_page(storage::Database& database, const HistoryQuery& query);
HistoryPage alarms_page(storage::Database& database, const HistoryQuery& query);
HistoryPage simulators_page(storage::Database& database, const HistoryQuery& query);
// Of one equipment, and of one of its versions.
HistoryPage blocks_page(storage::Database& database, const HistoryQuery& query);
HistoryPage scores_page(storage::Database& database, const HistoryQuery& query);

// From the archive. Parameters are of one spacecraft, samples and completeness of one series.
HistoryPage parameters_page(storage::Database& database, const HistoryQuery& query);
HistoryPage series_page(storage::Database& database, const HistoryQuery& query);
HistoryPage sources_page(storage::Database& database, const HistoryQuery& query);
HistoryPage sequence_gaps_page(storage::Database& database, const HistoryQuery& query);
HistoryPage samples_page(storage::Database& database, const HistoryQuery& query);
HistoryPage completeness_page(storage::Database& database, const HistoryQuery& query);

}  // namespace reident::history
