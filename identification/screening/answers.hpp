// Whether other channels answer excursions of one, which a slow output does in the rows that
// follow. Private to this folder. Nothing here throws.
#pragma once

#include <vector>

#include "identification/screening/witnesses.hpp"

namespace reident::identification {

/// Returns the excursions that no other channel answers, one by one or the rest of them together
/// (METHOD.md, section 17). Each channel is predicted from the rows before and from the others,
/// with the excursions taken out. It answers where it errs around them, in proportion to their
/// heights, clearly more than in as many places elsewhere. The cost is linear in the rows.
std::vector<Excursion> unanswered(const Witnesses& witnesses, std::vector<Excursion> excursions);

/// Returns the excursions that the rows before do not lead to expect. The channel is predicted from
/// its own two rows before and from each other channel at the lag at which it follows that, with
/// the excursions taken out. An excursion is expected that stands out as far as predicted, by half
/// to twice. The cost is linear in the rows.
std::vector<Excursion> unexpected(const Witnesses& witnesses, std::vector<Excursion> excursions);

}  // namespace reident::identification
