// One state of a database for several reads.
#pragma once

#include <memory>

#include "storage/database/database.hpp"

namespace reident::storage {

namespace sqlite {
class ReadTransaction;
}

/// All that is read from `database` while this exists is of one state, and costs less than reads of
/// their own. To be held for less than a second: the log grows meanwhile (SCHEMA.md). The
/// database must outlive it. Throws Error.
class Snapshot {
 public:
  explicit Snapshot(Database& database);
  ~Snapshot();
  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

 private:
  std::unique_ptr<sqlite::ReadTransaction> transaction_;
};

}  // namespace reident::storage
