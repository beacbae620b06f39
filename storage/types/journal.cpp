#include "storage/types/journal.hpp"

#include <algorithm>

namespace reident::storage {
namespace {

/// Position of the last row of the term at `index`.
std::int64_t end_of(const std::vector<Term>& terms, std::size_t index, std::int64_t last) {
  return index + 1 < terms.size() ? terms[index + 1].first - 1 : last;
}

}  // namespace

std::int64_t common_end(const std::vector<Term>& ours, std::int64_t our_last,
                        const std::vector<Term>& theirs, std::int64_t their_last) {
  for (std::size_t i = ours.size(); i-- > 0;) {
    const auto same = std::find(theirs.begin(), theirs.end(), ours[i]);
    if (same == theirs.end()) continue;
    const auto index = static_cast<std::size_t>(same - theirs.begin());
    return std::min(end_of(ours, i, our_last), end_of(theirs, index, their_last));
  }
  return 0;
}

}  // namespace reident::storage
