// Quantiles of the distributions that tests and intervals are made of.
#pragma once

namespace reident::identification {

/// z with P(Z <= z) = p for a standard normal Z; p in (0, 1).
double normal_quantile(double p);

/// Of chi-squared with `degrees` >= 1, by E. B. Wilson and M. M. Hilferty (PNAS 17(12), 1931):
/// within 0.2 % at p = 0.95 from three degrees on, 2.5 % for one.
double chi_squared_quantile(double p, double degrees);

/// Of Student's t with `degrees` >= 5, by the expansion of R. A. Fisher and E. A. Cornish
/// (Technometrics 2(2), 1960): within 0.2 % at p = 0.975.
double student_quantile(double p, double degrees);

}  // namespace reident::identification
