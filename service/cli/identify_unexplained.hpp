// Rows that `reident identify` leaves out because a model shows that they are no measurements:
// neither the inputs nor the rows around explain them, an output stands at a limit, or the outputs
// do not follow an input (METHOD.md, section 11, "Limits", "Outliers" and "Inputs that are not
// followed").
#pragma once

#include "identification/search/identify.hpp"
#include "service/cli/identify_data.hpp"

namespace reident::cli {

/// Identifies. Takes rows that are such to the model out of the data, says which these are, and
/// identifies again without them, until they are the same as before. Where a model is no better
/// than the mean, the first to go is whatever stands out in an output, or else in any channel.
/// Returns the first result and changes nothing where that gives no model that errs less on the
/// rows that are left, or one to which no row is such.
identification::IdentifyResult identify_explained(IdentifyData& data,
                                                  const identification::IdentifyOptions& options);

}  // namespace reident::cli
