// Whether rows need the states that a model has more than a simpler one (METHOD.md, section 7,
// "Parsimony"). Private to the library. Nothing here throws.
#pragma once

#include <vector>

#include "identification/fit/output_error_fit.hpp"
#include "identification/samples/record.hpp"
#include "identification/search/folds.hpp"

namespace reident::identification {

/// Returns the parameters that a fit of order n, with m inputs and p outputs, has in so many
/// segments: those of the model up to a change of basis, and the initial states.
Index parameters_of(Index n, Index m, Index p, bool direct, Index segments);

/// The richer one of two fits to the same rows. The ratio of their likelihoods is distributed as
/// chi-squared where both are fits to errors that have the correlation and the colour of these. So
/// both are fitted again, to those mixtures of the outputs whose errors are uncorrelated.
class RicherFit {
 public:
  /// Takes a fit of least squares to `rows` of the record, with or without D.
  /// No mode of a fit becomes slower than the least rate, |ln| [1/row] of an eigenvalue.
  RicherFit(const Response& fit, bool direct, const Record& record, RowRange rows,
            double least_rate = 0);

  /// Whether the likelihood ratio refutes, at 99 %, that a simpler fit of least squares has all
  /// that is in the outputs, wherever the modes are that the richer one has more. `extra` are the
  /// parameters, at least 1, that it has more.
  bool refutes(const Response& simple, bool direct, Index extra) const;

  /// Returns the rows that count as one in its errors, at least 1: of the output where they last
  /// longest.
  double correlated_rows() const { return correlated_rows_; }

  /// Steps of the refinement that a fit of order n, above 0, takes again.
  static constexpr int steps = 25;

 private:
  /// With the errors of the fit.
  RicherFit(const Response& fit, bool direct, const Record& record, RowRange rows,
            double least_rate, const Matrix& errors);

  /// Fits again and returns the sums (p) of the squared errors, made white by these colours.
  Vector whitened_squares(const Response& fit, bool direct,
                          const std::vector<ErrorColour>& colours) const;

  /// Errors of an output that are made white by this colour, less the parameters of its fit.
  double degrees_of_freedom(const ErrorColour& colour) const;

  Matrix mixtures_;  // p x p, orthogonal
  Record mixed_;     // its outputs are the mixtures
  RowRange rows_;
  Index order_;
  Index parameters_;  // of a fit of this order to one output
  double least_rate_;
  std::vector<ErrorColour> colours_;
  Vector squares_;  // of its own
  double correlated_rows_;
};

/// Whether a fit errs no more than the steps of the outputs' values make it: by s / sqrt(12), a
/// tenth more allowed, where s is the least difference of two values of the output. What is
/// smaller, no rows can tell.
bool errs_within_steps(const Response& fit, const Record& record, RowRange rows);

/// Whether the inputs, added up in sums that decay by `rate` [1/row], explain more of a fit's
/// errors than chance does in 99 of 100 cases: then the outputs have a slow mode that the inputs
/// drive, and do not only drift. The errors are made white by their autoregression. What the modes
/// of the fit could explain is taken out first. True where the rows are too few to ask.
bool drives_slow_modes(const Response& fit, const Record& record, RowRange rows, double rate);

/// Whether the rows held out speak against the simpler of two models, by their errors on each fold:
/// the median of its errors over the other's is above what chance gives `extra` parameters that
/// mean nothing; and its squares, or their logarithms, are larger by two standard errors. `fitted`
/// and `held_out` are the rows of a fold that count, which are fewer where errors last.
bool errs_more(const std::vector<HeldOutError>& simple, const std::vector<HeldOutError>& rich,
               Index extra, double fitted, double held_out);

}  // namespace reident::identification
