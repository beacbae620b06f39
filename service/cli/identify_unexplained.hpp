// Rows that `reident identify` leaves out because a model shows that they are no measurements:
// neither the inputs nor the rows around explain them, or the output stands at a limit (METHOD.md,
// section 11, "Outliers" and "Limits").
#pragma once

#include "identification/search/identify.hpp"
#include "service/cli/identify_data.hpp"

namespace reident::cli {

/// Takes such rows of `found` out of the data, says which these are, and identifies again without
/// them, until they are the same as before. Changes nothing where that gives no model that errs
/// less on the rows that are left, or one to which no row is such.
void leave_out_unexplained(IdentifyData& data, identification::Identified& found,
                           const identification::IdentifyOptions& options);

}  // namespace reident::cli
