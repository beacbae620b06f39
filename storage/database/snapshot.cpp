#include "storage/database/snapshot.hpp"

#include "storage/database/connection.hpp"

namespace reident::storage {

Snapshot::Snapshot(Database& database)
    : transaction_(std::make_unique<sqlite::ReadTransaction>(connection(database))) {}

Snapshot::~Snapshot() = default;

}  // namespace reident::storage
