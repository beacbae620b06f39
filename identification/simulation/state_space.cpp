#include "identification/simulation/state_space.hpp"

#include <cmath>
#include <limits>

#include "identification/numerics/decompositions.hpp"

namespace reident::identification {

double spectral_radius(const StateSpaceModel& model) {
  return spectral_radius(model.A);
}

double slowest_time_constant_s(const StateSpaceModel& model) {
  return slowest_time_constant_s(model.A, model.period_s);
}

double slowest_time_constant_s(const Matrix& A, double period_s) {
  const double radius = spectral_radius(A);
  if (radius <= 0) return 0;
  return radius < 1 ? -period_s / std::log(radius) : std::numeric_limits<double>::infinity();
}

std::optional<Matrix> static_gain(const StateSpaceModel& model) {
  constexpr double well_conditioned = 1e-10;
  const Index n = model.order();
  if (n == 0) return model.D;
  // States may differ much in size, which says nothing of the gain.
  const Vector d = balancing(model.A), inverse = d.cwiseInverse();
  const auto states =
      solve_full_lu(Matrix::Identity(n, n) - inverse.asDiagonal() * model.A * d.asDiagonal(),
                    inverse.asDiagonal() * model.B, well_conditioned);
  if (!states) return std::nullopt;
  return model.C * d.asDiagonal() * *states + model.D;
}

bool is_stable(const Matrix& A) {
  return A.allFinite() && spectral_radius(A) < 1;
}

bool is_well_formed(const StateSpaceModel& model) {
  const Index n = model.order(), m = model.inputs(), p = model.outputs();
  const bool sizes = model.A.cols() == n && model.B.rows() == n && model.B.cols() == m &&
                     model.C.rows() == p && model.C.cols() == n && model.u0.size() == m &&
                     model.y0.size() == p;
  const bool gain = model.K.size() == 0 || (model.K.rows() == n && model.K.cols() == p);
  const bool finite = model.A.allFinite() && model.B.allFinite() && model.C.allFinite() &&
                      model.D.allFinite() && model.K.allFinite() && model.u0.allFinite() &&
                      model.y0.allFinite();
  return sizes && gain && finite && std::isfinite(model.period_s) && model.period_s > 0;
}

}  // namespace reident::identification
