// The codec of what is said of a model besides its matrices: diagnostics and continuous time
// (identification/METHOD.md, sections 10 and 11). It writes alone; nothing reads this JSON back.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "identification/search/identify.hpp"
#include "identification/simulation/continuous.hpp"
#include "identification/statistics/diagnostics.hpp"

namespace reident {

/// Returns the object that `reident identify --json` and the registry's evidence have. Requires the
/// names of the model's m inputs and p outputs, in its order. Arrays have an entry an output, those
/// of input correlations one for each pair. Errors and fits are in percent, lags in samples.
/// Where there is nothing to say (no K, too few rows for an interval) the key holds null or an
/// empty array; numbers that are not finite are null.
nlohmann::ordered_json to_json(const identification::Diagnostics& diagnostics,
                               const std::vector<std::string>& inputs,
                               const std::vector<std::string>& outputs);

/// Returns {"used", "held_out_error", "held_out_error_without"}; an error that is absent is null.
nlohmann::ordered_json to_json(const identification::RegimeChoice& regimes);

/// Returns {"A", "B"} of dx/dt = A x + B (u - u0), time in seconds, or {"rejected": code, "reason":
/// sentence} for a model that has no continuous form.
nlohmann::ordered_json to_json(
    const std::variant<identification::ContinuousModel, identification::Verdict>& continuous);

}  // namespace reident
