// The archive's reader and writer of an open database, shared by all that work on it. Private to
// storage.
#pragma once

#include <optional>

#include "storage/archive/series_reader.hpp"
#include "storage/archive/writer.hpp"
#include "storage/database/connection.hpp"

namespace reident::storage {

class ArchiveAccess : public Database::Attachment {
 public:
  explicit ArchiveAccess(sqlite::Connection& connection)
      : connection_(connection), reader_(connection) {}

  SeriesReader& reader() { return reader_; }

  /// Gives `work` the writer, made again where its knowledge may be wrong. Call within a
  /// transaction.
  template <typename Work>
  auto write(const ArchiveOptions& options, const Work& work) {
    if (!writer_ || !writer_->is_current()) writer_.emplace(connection_, options);
    try {
      return work(*writer_);
    } catch (...) {
      writer_.reset();
      throw;
    }
  }

 private:
  sqlite::Connection& connection_;
  SeriesReader reader_;
  std::optional<Writer> writer_;
};

/// Made at the first call for a database; lives as long as that.
ArchiveAccess& archive_access(const Database& database);

}  // namespace reident::storage
