#include "service/support/version.hpp"

namespace reident {

std::string_view program_version() {
  return REIDENT_VERSION;
}

}  // namespace reident
