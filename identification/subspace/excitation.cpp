#include "identification/subspace/excitation.hpp"

#include <cmath>

#include "identification/numerics/decompositions.hpp"

namespace reident::identification {

std::vector<RedundantInput> redundant_inputs(const Matrix& u) {
  constexpr double of_its_own = 1e-6;
  constexpr double taking_part = 1e-3;
  std::vector<RedundantInput> found;
  std::vector<Index> kept;
  for (Index j = 0; j < u.cols(); ++j) {
    const Matrix before = u(Eigen::all, kept);
    const Vector weights = solve_qr(before, u.col(j));
    const double rest = (u.col(j) - before * weights).norm();
    if (kept.empty() || rest > of_its_own * u.col(j).norm()) {
      kept.push_back(j);
      continue;
    }
    RedundantInput redundant{j, {}};
    for (std::size_t i = 0; i < kept.size(); ++i)
      if (std::abs(weights(static_cast<Index>(i))) > taking_part)
        redundant.explained_by.push_back(kept[i]);
    found.push_back(redundant);
  }
  return found;
}

bool are_independent(const Matrix& correlation) {
  if (correlation.rows() == 0) return true;
  // A sum of squares does not distinguish the square of 1e-6 from rounding.
  constexpr double clearly = 1e-4;
  return Cholesky::of(correlation, clearly).has_value();
}

Excitation excitation_of(const Matrix& input_innovations) {
  constexpr double least_innovation = 1e-7;
  Excitation excitation;
  for (Index strongest = 0; excitation.order < input_innovations.rows(); ++excitation.order) {
    if (input_innovations.row(excitation.order).maxCoeff(&strongest) < least_innovation) break;
    excitation.strongest_input = strongest;
  }
  return excitation;
}

}  // namespace reident::identification
