// N4SID with the order, the horizon and the weighting chosen by score on held-out samples.
//
// The reference is P. Van Overschee and B. De Moor, "N4SID: Subspace algorithms for the
// identification of combined deterministic-stochastic systems", Automatica 30(1), 1994; METHOD.md
// holds the notation and the equations.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "identification/record.hpp"
#include "identification/simulate.hpp"
#include "identification/state_space.hpp"
#include "identification/verdict.hpp"

namespace reident::identification {

enum class Weighting { n4sid, moesp, cva };
std::string_view name(Weighting weighting);

struct IdentifyOptions {
  std::optional<int> order;  // absent: chosen in [min_order, max_order]
  int min_order = 1;
  int max_order = 10;
  std::optional<int> horizon;          // block rows s; absent: chosen
  std::optional<Weighting> weighting;  // absent: chosen
  /// Share of the identification rows that choices are scored on; in (0, 0.9]. The last rows are
  /// held out, and in a second fold the first.
  double tune_share = 0.3;
  /// Called as each phase of the work begins, with a literal such as "compress"; for timing.
  std::function<void(std::string_view phase)> on_phase;
};

/// Every mistake in the options, one sentence each; empty when they are usable.
std::vector<std::string> mistakes(const IdentifyOptions& options);

struct Identified {
  StateSpaceModel model;
  Vector x0;  // state at the first identification row
  int horizon = 0;
  Weighting weighting = Weighting::n4sid;
  double spectral_radius = 0;
  Vector singular_values;       // of the weighted oblique projection, descending
  Vector input_min, input_max;  // range visited by each input in the identification rows
  double held_out_error = 0;    // of the choice: rms in deviations of the outputs, over both folds
  Score tune;  // of the model on the last tune_share of the rows, which it was fitted to as well
  std::vector<std::string> warnings;
};

using IdentifyResult = std::variant<Identified, Verdict>;

/// Identifies from the rows `rows` of the record alone; nothing else of it is read.
/// Requires m >= 0 inputs, p >= 1 outputs and mistakes(options).empty().
IdentifyResult identify(const Record& record, RowRange rows, const IdentifyOptions& options);

}  // namespace reident::identification
