// Diagnostics of a model in words and figures for a terminal.
#pragma once

#include <string>
#include <vector>

#include "identification/statistics/diagnostics.hpp"

namespace reident::cli {

/// Names are those of the model's inputs and outputs, in its order.
std::string diagnostics_text(const identification::Diagnostics& diagnostics,
                             const std::vector<std::string>& inputs,
                             const std::vector<std::string>& outputs);

}  // namespace reident::cli
