// What a Database holds. Private to storage.
#pragma once

#include <filesystem>
#include <optional>

#include "storage/series_reader.hpp"
#include "storage/sqlite.hpp"
#include "storage/writer.hpp"
#include "storage/writer_lock.hpp"

namespace reident::storage {

// The connection closes, and folds the log into the file, before the lock is given up.
struct Database::Impl {
  std::filesystem::path path;
  std::optional<WriterLock> lock;
  std::optional<sqlite::Connection> connection;

  SeriesReader& reader() {
    if (!reader_) reader_.emplace(*connection);
    return *reader_;
  }
  /// Gives `work` the writer, made anew where its knowledge may be wrong. Call within a
  /// transaction.
  template <typename Work>
  auto write(const ArchiveOptions& options, const Work& work) {
    if (!writer_ || !writer_->is_current()) writer_.emplace(*connection, options);
    try {
      return work(*writer_);
    } catch (...) {
      forget_writer();
      throw;
    }
  }
  /// To be called by whoever changes series, chunks or recent runs beside the writer.
  void forget_writer() { writer_.reset(); }

 private:
  std::optional<SeriesReader> reader_;
  std::optional<Writer> writer_;
};

}  // namespace reident::storage
