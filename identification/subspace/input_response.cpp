#include "identification/subspace/input_response.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/kernels.hpp"
#include "identification/subspace/shift_invariance.hpp"

namespace reident::identification {
namespace {

/// Block rows of the future that B and D are fitted to: more cost much and add little.
constexpr Index longest_response = 20;

/// Least squares of a target row on the rows above it, from their inner products: `sums` before and
/// `removed` what a projection takes away of them. Absent where too few digits would be left.
std::optional<Vector> solve_sums(const Matrix& sums, const Matrix& removed) {
  const Index unknowns = sums.rows() - 1;
  const Vector scale = sums.diagonal().head(unknowns).unaryExpr(
      [](double w) { return w > 0 ? 1 / std::sqrt(w) : 0.0; });
  const Matrix left = (sums - removed).triangularView<Eigen::Lower>();
  const Matrix G = scale.asDiagonal() * left.topLeftCorner(unknowns, unknowns) * scale.asDiagonal();
  constexpr double least_pivot = 1e-5;  // its square is the share of a row that is its own
  const auto cholesky = Cholesky::of(G, least_pivot);
  if (!cholesky) return std::nullopt;
  const Vector right = scale.asDiagonal() * left.row(unknowns).head(unknowns).transpose();
  return Vector(scale.asDiagonal() * cholesky->solve(right));
}

/// The regression for B and D. Each coordinate of U_f is a short experiment: inputs v of L_uu,
/// outputs of L_yu. Nothing moves before the block row whose input it is.
class Experiments {
 public:
  Experiments(const Projection& projection, const Matrix& A, const Matrix& C, bool direct)
      : L_(projection.L()),
        m_(projection.inputs()),
        p_(projection.outputs()),
        block_rows_(std::min<Index>(projection.horizon(), longest_response)),
        direct_(direct),
        At_(A.transpose()),
        Ct_(C.transpose()) {}

  Index block_rows() const { return block_rows_; }
  Index count() const { return m_ * block_rows_; }
  Index unknowns() const { return (At_.rows() + (direct_ ? p_ : 0)) * m_; }
  /// Outputs of experiment j, and how many of them lie before it.
  auto outputs(Index j) const { return L_.yu.col(j).head(p_ * block_rows_); }
  Index before(Index j) const { return j / m_ * p_; }

  /// Writes what multiplies the unknowns in the outputs of experiment j that do not lie before it,
  /// and each of these outputs behind: unknowns() + 1 entries a column.
  void write_rows(Index j, double* to) {
    const Index n = At_.rows(), first = j / m_, height = unknowns() + 1;
    const double* v = L_.uu.col(j).data() + first * m_;
    for (Index q = 0; q < p_; ++q) {
      states_.setZero(n, m_);
      run_dual_filters(At_.data(), Ct_.col(q).data(), n, m_, v, block_rows_ - first, states_.data(),
                       to + q * height, p_ * height);
    }
    for (Index k = first; k < block_rows_; ++k, v += m_)
      for (Index q = 0; q < p_; ++q, to += height) {
        if (direct_) {
          std::fill_n(to + n * m_, p_ * m_, 0.0);
          std::copy_n(v, m_, to + (n + q) * m_);
        }
        to[height - 1] = L_.yu(k * p_ + q, j);
      }
  }

 private:
  const Projection::Blocks& L_;
  Index m_, p_, block_rows_;
  bool direct_;
  Matrix At_, Ct_, states_;
};

/// Least squares, or the solution of least norm, from all rows at once.
Vector solve_rows(Experiments& experiments, const Matrix& Q) {
  const Index unknowns = experiments.unknowns(), of_one = Q.rows();
  Matrix rows = Matrix::Zero(unknowns + 1, experiments.count() * of_one);
  for (Index j = 0; j < experiments.count(); ++j) {
    auto own = rows.middleCols(j * of_one, of_one);
    experiments.write_rows(j, own.col(experiments.before(j)).data());
    own.row(unknowns) = experiments.outputs(j).transpose();
    own -= (own * Q) * Q.transpose();
  }
  return solve_least_norm(rows.topRows(unknowns).transpose(),
                          Vector(rows.row(unknowns).transpose()));
}

}  // namespace

StateSpaceModel with_response(const Projection& projection, const Matrix& A, const Matrix& C,
                              bool direct, double period_s) {
  const Index n = A.rows(), m = projection.inputs(), p = projection.outputs();
  StateSpaceModel model{
      A, Matrix::Zero(n, m), C, Matrix::Zero(p, m), {}, Vector::Zero(m), Vector::Zero(p), period_s};
  Experiments experiments(projection, A, C, direct);
  if (experiments.count() == 0) return model;
  const Matrix Q = orthonormal_basis(extended_observability(A, C, experiments.block_rows()));
  const Matrix Qt = Q.transpose();
  const Index unknowns = experiments.unknowns(), height = unknowns + 1;
  Matrix rows(height, Q.rows()), along_gamma = Matrix::Zero(height, experiments.count() * n);
  Matrix sums = Matrix::Zero(height, height), removed = sums;
  for (Index j = 0; j < experiments.count(); ++j) {
    const Index before = experiments.before(j), count = Q.rows() - before;
    experiments.write_rows(j, rows.data());
    const VectorSequence sequence{rows.data(), height, height};
    add_outer_products(sequence, sequence, count, Triangle::lower, sums.data());
    add_outer_products(sequence, {Qt.data() + before * n, n, n}, count, Triangle::full,
                       along_gamma.data() + j * n * height);
    along_gamma.row(unknowns).segment(j * n, n).noalias() = Qt * experiments.outputs(j);
  }
  const VectorSequence along{along_gamma.data(), height, height};
  add_outer_products(along, along, along_gamma.cols(), Triangle::lower, removed.data());
  const auto solution = solve_sums(sums, removed);
  const Vector theta = solution ? *solution : solve_rows(experiments, Q);
  model.B = theta.head(n * m).reshaped(n, m);
  if (direct) model.D = theta.tail(p * m).reshaped(m, p).transpose();
  return model;
}

}  // namespace reident::identification
