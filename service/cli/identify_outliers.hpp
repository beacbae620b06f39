// Rows that `reident identify` leaves out because neither the inputs nor the rows around explain
// them (METHOD.md, section 11, "Outliers").
#pragma once

#include "identification/search/identify.hpp"
#include "service/cli/identify_data.hpp"

namespace reident::cli {

/// Takes the rows at which an output stands out of what `found` explains out of the data, says
/// which these are, and identifies again without them, until they are the same as before. Changes
/// nothing where that gives no model that errs less on the rows that are left.
void leave_out_outliers(IdentifyData& data, identification::Identified& found,
                        const identification::IdentifyOptions& options);

}  // namespace reident::cli
