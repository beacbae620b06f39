// Quantiles of the distributions that tests and intervals are made of; p is in (0, 1).
#pragma once

namespace reident::identification {

/// Returns z with P(Z <= z) = p for a standard normal Z.
double normal_quantile(double p);

/// Returns that of chi-squared, degrees >= 1: from three on within 0.2 % at p = 0.95, else 2.5 %.
double chi_squared_quantile(double p, double degrees);

/// Returns what chi-squared with degrees >= 1 exceeds with this probability, 1e-300 to 1.
double chi_squared_limit(double probability, int degrees);

/// Returns that of Student's t, degrees >= 5: within 0.2 % at p = 0.975.
double student_quantile(double p, double degrees);

}  // namespace reident::identification
