// The codec of what is said of a model besides its matrices: diagnostics and continuous time.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "identification/simulation/continuous.hpp"
#include "identification/statistics/diagnostics.hpp"

namespace reident {

/// Names are those of the model's inputs and outputs, in its order. Arrays have an entry an output.
/// Where there is nothing to say (no K, too few rows for an interval) the key holds null or an
/// empty array; numbers that are not finite are null.
nlohmann::ordered_json to_json(const identification::Diagnostics& diagnostics,
                               const std::vector<std::string>& inputs,
                               const std::vector<std::string>& outputs);

/// {"A", "B"}, or {"rejected": code, "reason": sentence}.
nlohmann::ordered_json to_json(
    const std::variant<identification::ContinuousModel, identification::Verdict>& continuous);

}  // namespace reident
