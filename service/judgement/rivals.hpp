// What a candidate is measured against: the mean, the simulator's own model and the champion, each
// on the samples that judge the candidate.
#pragma once

#include <optional>
#include <vector>

#include "service/judgement/gate.hpp"
#include "service/windows/candidate.hpp"
#include "storage/archive/archive.hpp"
#include "storage/registry/registry.hpp"

namespace reident {

/// Rows of `u` (N x m) at which an input is outside its range in `inputs`, by more
/// than noise: a twentieth of its width.
std::vector<identification::Index> rows_outside(const identification::Matrix& u,
                                                const std::vector<Signal>& inputs);

/// `confidence_percent` is that of the lower bounds, in percent.
Evidence::Comparison against_mean(const PreparedWindow& prepared, double confidence_percent);

/// Telemetry of the simulator itself (origin simulated); absent where it covers less than half of
/// the validation part.
std::optional<Evidence::Comparison> against_simulator(const storage::Archive& archive,
                                                      const PreparedWindow& prepared,
                                                      double confidence_percent);

/// Absent where there is no champion; without a comparison where it is damaged in the registry, or
/// has other outputs.
std::optional<Evidence::Champion> against_champion(const storage::Archive& archive,
                                                   const storage::Registry& registry,
                                                   const PreparedWindow& prepared,
                                                   double confidence_percent,
                                                   double margin_percent);

}  // namespace reident
