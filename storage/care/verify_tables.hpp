// The parts of verify that look at whole tables. Private to storage.
#pragma once

#include <functional>

#include "storage/care/verify.hpp"
#include "storage/database/sqlite.hpp"

namespace reident::storage {

/// SQLite's own check: pages, rows, indexes, and references between tables. False when
/// `go_on`, which is asked about every 10 ms, said no.
bool verify_pages(sqlite::Connection& connection, bool quick, VerifyReport& report,
                  const std::function<bool()>& go_on);

/// Tables, indexes, views and triggers are those that this program makes.
void verify_schema(sqlite::Connection& connection, VerifyReport& report);

/// The sequence gaps of each source, and its count of missing numbers.
void verify_sources(sqlite::Connection& connection, VerifyReport& report);

/// Rows that contradict themselves or each other.
void verify_rows(sqlite::Connection& connection, VerifyReport& report);

}  // namespace reident::storage
