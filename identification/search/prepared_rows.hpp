// The rows of one identification, prepared: what the choice and the realisation of a model work on
// (METHOD.md, sections 1 to 4). Private to this folder. Nothing here throws.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "identification/samples/record.hpp"
#include "identification/samples/verdict.hpp"
#include "identification/search/folds.hpp"
#include "identification/search/identify.hpp"
#include "identification/subspace/hankel.hpp"
#include "identification/subspace/lag_sums.hpp"
#include "identification/subspace/normalise.hpp"

namespace reident::identification {

/// Rows are given by reference and nothing of them is copied until normalised() is asked for.
class PreparedRows {
 public:
  /// Takes `rows` of the record; the last `options.tune_rows` are for choices alone, the others are
  /// fitted. Sums come from `sums`, and with `keep` stay there. Arguments outlive the object.
  PreparedRows(const Record& record, RowRange rows, const IdentifyOptions& options, LagSums& sums,
               bool keep);

  /// Checks the samples, sums them and leaves out the channels that say nothing, with a warning
  /// each. Comes before all else. Returns a verdict where nothing is left to identify.
  std::optional<Verdict> prepare(std::vector<std::string>& warnings);

  /// Return what was given.
  const Record& record() const { return record_; }
  const IdentifyOptions& options() const { return options_; }
  /// Return the rows of the record that are fitted, and their segments counted from the first of
  /// them.
  RowRange fitted() const { return fitted_; }
  const std::vector<Segment>& segments() const { return segments_; }
  /// Returns the folds of the fitted and the tuning rows, counted from the first fitted one: one
  /// with tuning rows, else the four of folds_of().
  std::vector<Fold> folds() const;

  /// Return the channels that take part, how many they are, and the name of one of the record's
  /// inputs as verdicts and warnings hold it.
  const Normalisation& normalisation() const { return normalisation_; }
  Index inputs() const { return static_cast<Index>(normalisation_.inputs.size()); }
  Index outputs() const { return static_cast<Index>(normalisation_.outputs.size()); }
  std::string input_name(Index input) const;

  /// Return the sums, in units, of all fitted rows, and of a part of them counted from the first.
  const RangeSums& sums() const { return sums_; }
  RangeSums sums_of(RowRange part);
  /// Returns the fitted and the tuning rows, normalised, without the channels left out. Made when
  /// first asked for: a model that follows from the sums alone needs no rows.
  const Record& normalised();
  /// Returns the compression of all fitted rows, made when first asked for. Requires a horizon of
  /// at most half of the block rows of the sums.
  const HankelFactor& factor(int horizon);

  /// Returns the rows without a gap that a horizon takes with `width` = m + p channels, where rows
  /// are held out as the options say.
  Index rows_needed(int horizon, Index width) const;
  /// Returns the verdict on rows that do not feed the least horizon with m inputs and p outputs. It
  /// names the number of rows that would.
  Verdict too_few_samples(Index m, Index p) const;

 private:
  /// Warns of each channel that does not move; the `kind` is "input" or "output".
  void warn_of_constants(const std::vector<Index>& moving, Index channels, const char* kind,
                         std::vector<std::string>& warnings) const;
  /// Takes inputs that others explain at every row out of the normalisation, with a warning each.
  void leave_out_redundant_inputs(std::vector<std::string>& warnings);

  const Record& record_;
  /// Rows of the record. The tuning rows follow the fitted ones; where there are none, some of the
  /// fitted rows are held out in turn.
  RowRange fitted_, tune_;
  const IdentifyOptions& options_;
  LagSums& lag_sums_;
  bool keep_;
  RangeSums sums_;
  Normalisation normalisation_;
  std::vector<Segment> segments_;
  std::optional<Record> normalised_;
  /// By the horizon.
  std::map<int, HankelFactor> factors_;
};

}  // namespace reident::identification
