// What would have been, compared with what really was: which versions when, and what they erred on
// the same telemetry.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "service/config/config.hpp"
#include "storage/registry/registry.hpp"

namespace reident::sweep {

/// Compares the registry of a sweep with that of the configuration's database, for each equipment
/// of the spacecraft. An entry an equipment:
///
///   equipment
///   would, was   each of: publications [{since_ns, version}], version 0 where none ran any more,
///                the first one of before where the range begins later; blocks, how many of the
///                range a version ran on; mrse_percent, null without one; regret (below), null
///                where it is not known
///   common       blocks, would_mrse_percent, was_mrse_percent: on blocks that both have a version
///                for; would_regret, was_regret: over cycles that both know. Null where there is
///                none
///   outcomes     what came of the windows of the sweep, in words: "40 not_excited, 2 challenger"
///   note         what keeps the two from being compared as they are; empty else
///
/// Errors are of free runs without interruption, as in a simulator, on blocks that count. Regret is
/// the geometric mean, over the cycles, of the champion's error over the least one of all versions
/// that were scored there: 1 is perfect hindsight. Throws storage::Error.
nlohmann::ordered_json compare(storage::Database& sweep, const Config& config,
                               const std::string& spacecraft, storage::TimeRange range);

/// SHA-256, hexadecimal, of all that a registry decided: attempts, models, scores and decisions,
/// but for the time that the work took.
std::string registry_digest(storage::Database& database);

}  // namespace reident::sweep
