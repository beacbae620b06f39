#include "service/cli/file_errors.hpp"

namespace reident::cli {

int refusing_what_cannot_be(const std::function<int()>& work) {
  try {
    return work();
  } catch (const storage::Error& error) {
    using Kind = storage::Error::Kind;
    const Kind kind = error.kind();
    if (kind == Kind::full || kind == Kind::corrupt || kind == Kind::failed ||
        kind == Kind::displaced)
      throw;
    return refuse({error.what()});
  }
}

}  // namespace reident::cli
