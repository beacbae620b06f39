#include "storage/archive/archive_access.hpp"

namespace reident::storage {

ArchiveAccess& archive_access(const Database& database) {
  Database::Impl& impl = database.impl();
  if (!impl.archive) impl.archive = std::make_unique<ArchiveAccess>(*impl.connection);
  return static_cast<ArchiveAccess&>(*impl.archive);
}

}  // namespace reident::storage
