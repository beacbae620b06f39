// The autoregression of a series, and what makes the series white (METHOD.md, section 7,
// "Parsimony"). Nothing here throws.
#pragma once

#include <vector>

#include "identification/statistics/correlation.hpp"

namespace reident::identification {

/// Predictors of a series from its own past, of every order up to the last one.
struct Autoregression {
  std::vector<Vector> coefficients{Vector(0)};  // [k]: k of them, that of the latest value first
  std::vector<double> deviation{1};             // [k]: of what order k leaves, over the series' own

  Index order() const { return static_cast<Index>(coefficients.size()) - 1; }
};

/// The errors of one output of a model.
struct ErrorColour {
  Autoregression past;
  double deviation = 1;  // of what the past does not explain
};

/// Returns the autoregression with the least BIC, by Levinson's recursion; at most 20 coefficients,
/// a twentieth of the rows, and fewer than the longest segment.
Autoregression autoregression(Series& series);

/// Returns the coefficients by Burg's method, which does not shorten a drift as products of lags
/// do: as many as the rows carry, at most 20 and a twentieth of them, that of the latest value
/// first. One of the least BIC misses what drifts below other noise.
Vector burg_coefficients(const Vector& values, const std::vector<RowRange>& segments);

/// What the past of a series leaves of it, over the rows that have as much past.
struct Innovations {
  double squares = 0;  // their sum
  Index rows = 0;
};

/// Returns them for the coefficients of an autoregression, that of the latest value first.
Innovations innovations_of(const Vector& values, const Vector& coefficients,
                           const std::vector<RowRange>& segments);

}  // namespace reident::identification
