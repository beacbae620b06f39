// How the commands that work on a database file distinguish a request that cannot be met from a
// machine that fails.
#pragma once

#include <functional>

#include "service/cli/command.hpp"
#include "storage/database/database.hpp"

namespace reident::cli {

/// What `work` returns. An Error that names a wrong file, a lock or a permission is refused; a full
/// disk, damage and what else no other request would mend is thrown on.
int refusing_what_cannot_be(const std::function<int()>& work);

}  // namespace reident::cli
