#include "identification/correction/pole_placement.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "identification/correction/least_norm_block.hpp"
#include "identification/numerics/decompositions.hpp"
#include "identification/numerics/schur_blocks.hpp"

namespace reident::identification {
namespace {

constexpr double negligible = 1e-7;

[[maybe_unused]] bool is_self_conjugate(const Poles& poles) {
  for (std::size_t i = 0; i < poles.size(); ++i) {
    if (!std::isfinite(poles[i].real()) || !std::isfinite(poles[i].imag())) return false;
    if (poles[i].imag() == 0) continue;
    if (i + 1 == poles.size() || poles[i + 1] != std::conj(poles[i])) return false;
    ++i;
  }
  return true;
}

/// Takes the value nearest to `pole` out of `values`, which are not empty.
std::complex<double> take_nearest(Poles& values, std::complex<double> pole) {
  const auto nearest = std::min_element(
      values.begin(), values.end(),
      [pole](const auto& a, const auto& b) { return std::abs(a - pole) < std::abs(b - pole); });
  const std::complex<double> value = *nearest;
  values.erase(nearest);
  return value;
}

/// Powers of two that make each row of D^-1 A D as large as the column of the same state (B. N.
/// Parlett, C. Reinsch, "Balancing a matrix for calculation of eigenvalues and eigenvectors",
/// Numerische Mathematik 13, 1969): else the largest states' rounding moves the smallest ones.
Vector balance(const Matrix& A) {
  constexpr int sweeps = 50;
  const Index n = A.rows();
  Vector d = Vector::Ones(n);
  Matrix off_diagonal = A.cwiseAbs();
  off_diagonal.diagonal().setZero();
  bool settled = false;
  for (int sweep = 0; sweep < sweeps && !settled; ++sweep) {
    settled = true;
    for (Index i = 0; i < n; ++i) {
      const double row = off_diagonal.row(i).sum(), column = off_diagonal.col(i).sum();
      if (!(row > 0 && column > 0)) continue;
      const double factor = std::exp2(std::round(std::log2(row / column) / 2));
      if (factor == 1 || column * factor + row / factor > 0.95 * (row + column)) continue;
      settled = false;
      d(i) *= factor;
      off_diagonal.row(i) /= factor;
      off_diagonal.col(i) *= factor;
    }
  }
  return d;
}

class Placement {
 public:
  Placement(const Matrix& A, const Matrix& B, const Poles& wanted);

  std::variant<PolePlacement, Verdict> run();

 private:
  auto rows_of(Index block) { return B_.middleRows(schur_.first_row(block), schur_.size(block)); }

  /// False where blocks of different size stayed.
  bool swap(Index block);

  bool leave_unreached();

  /// Brings the input rows of a block of two to [sigma_1 v_1'; sigma_2 v_2'], and splits it where
  /// the second is zero and its state does not follow the first.
  bool leave_unreached_part();

  bool more_pairs_than_blocks_of_two() const;

  /// Takes the last state and the next single one above it as one block, where there is one.
  bool join_another();

  void place(Index block);

  /// Makes two blocks of a block of two with two real poles, of which one is given: single states
  /// can always be exchanged.
  void separate(Index block, double pole);

  /// Brings the blocks just placed to the upper end.
  bool raise_placed();

  Matrix feedback_of_one(Index block);

  /// leave_unreached_part() has made the input rows orthogonal. `first` is one of the poles taken.
  Matrix feedback_of_two(Index block, std::complex<double>& first);

  SchurBlocks schur_;
  Vector input_size_;
  Matrix B_;     // Q' B, each input in its own size
  Matrix gain_;  // of inputs so measured
  Poles reals_, pairs_, uncontrollable_;
  double unreached_ = 0;
  Index just_placed_ = 0;
  Index placed_ = 0;  // blocks at the upper end that are done
  Index end_ = 0;     // blocks below are out of reach
};

Placement::Placement(const Matrix& A, const Matrix& B, const Poles& wanted)
    : schur_(A), input_size_(B.cols()), gain_(Matrix::Zero(B.cols(), A.rows())) {
  for (Index j = 0; j < B.cols(); ++j) {
    const double size = B.col(j).stableNorm();
    input_size_(j) = size > 0 ? size : 1;
  }
  if (schur_.count() > 0) B_ = schur_.Q().transpose() * B * input_size_.cwiseInverse().asDiagonal();
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto& pole = wanted[i];
    if (pole.imag() == 0)
      reals_.push_back(pole);
    else
      pairs_.emplace_back(pole.real(), std::abs(wanted[i++].imag()));
  }
  unreached_ = negligible * B_.norm();
  end_ = schur_.count();
}

std::variant<PolePlacement, Verdict> Placement::run() {
  if (schur_.count() == 0 && gain_.cols() > 0)
    return Verdict{VerdictCode::no_gain, "the eigenvalues of A are not found"};
  while (placed_ < end_) {
    if (leave_unreached() || leave_unreached_part()) continue;
    if (schur_.size(end_ - 1) == 1 && more_pairs_than_blocks_of_two() && join_another()) continue;
    if (schur_.size(end_ - 1) == 1 && reals_.empty())
      return Verdict{VerdictCode::no_gain,
                     "a pair of poles is wanted where the inputs reach a single mode"};
    place(end_ - 1);
    if (!raise_placed())
      return Verdict{VerdictCode::no_gain,
                     "a wanted pair of poles is so near to a pole of A that they cannot be told "
                     "apart"};
  }
  PolePlacement result{input_size_.cwiseInverse().asDiagonal() * gain_, uncontrollable_};
  if (!result.gain.allFinite())
    return Verdict{VerdictCode::no_gain, "the gain that moves the poles there is not finite"};
  return result;
}

bool Placement::swap(Index block) {
  const Index size = schur_.size(block), next = schur_.size(block + 1);
  const Matrix Z = schur_.swap_with_next(block);
  auto rows = B_.middleRows(schur_.first_row(block), Z.rows());
  rows = (Z.transpose() * rows).eval();
  return schur_.size(block) == next && schur_.size(block + 1) == size;
}

bool Placement::leave_unreached() {
  const Index last = end_ - 1;
  if (!(rows_of(last).norm() <= unreached_)) return false;
  const std::complex<double> pole = schur_.eigenvalue(last);
  uncontrollable_.push_back(pole);
  if (schur_.size(last) == 2) uncontrollable_.push_back(std::conj(pole));
  rows_of(last).setZero();
  --end_;
  return true;
}

bool Placement::leave_unreached_part() {
  const Index last = end_ - 1, row = schur_.first_row(last);
  if (schur_.size(last) == 1) return false;
  const Matrix U = left_singular(rows_of(last), SingularVectors::full).U;
  schur_.rotate(last, U);
  rows_of(last) = (U.transpose() * rows_of(last)).eval();
  const double sigma_2 = rows_of(last).row(1).norm();
  if (sigma_2 > unreached_) return false;
  if (std::abs(schur_.T()(row + 1, row)) > negligible * schur_.T().norm()) return false;
  schur_.split(last);
  ++end_;
  return true;
}

bool Placement::more_pairs_than_blocks_of_two() const {
  Index blocks = 0;
  for (Index block = placed_; block < end_; ++block) blocks += schur_.size(block) == 2 ? 1 : 0;
  return static_cast<Index>(pairs_.size()) > blocks;
}

bool Placement::join_another() {
  for (Index block = end_ - 2; block >= placed_; --block) {
    if (schur_.size(block) != 1) continue;
    for (Index below = block; below + 2 < end_; ++below) swap(below);
    // A block that could not be exchanged with its like stays where it was.
    if (schur_.size(end_ - 2) != 1) return false;
    schur_.join_with_next(end_ - 2);
    --end_;
    return true;
  }
  return false;
}

void Placement::place(Index block) {
  const Index row = schur_.first_row(block), size = schur_.size(block);
  const bool pair = size == 2 && !pairs_.empty();
  std::complex<double> pole;
  const Matrix feedback = size == 1 ? feedback_of_one(block) : feedback_of_two(block, pole);
  schur_.subtract_from_columns(block, B_ * feedback);
  gain_ += feedback * schur_.Q().middleCols(row, size).transpose();
  just_placed_ = 1;
  if (size == 2 && !pair) separate(block, pole.real());
}

void Placement::separate(Index block, double pole) {
  const Index row = schur_.first_row(block);
  const Eigen::Matrix2d T = schur_.T().block<2, 2>(row, row) - pole * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d v = least_right_singular(T);  // T v = 0
  Matrix Z(2, 2);
  Z << v(0), -v(1), v(1), v(0);
  schur_.rotate(block, Z);
  rows_of(block) = (Z.transpose() * rows_of(block)).eval();
  schur_.split(block);
  ++end_;
  just_placed_ = 2;
}

bool Placement::raise_placed() {
  for (Index first = end_ - just_placed_; just_placed_ > 0; --just_placed_, ++first, ++placed_)
    for (Index block = first; block > placed_; --block)
      if (!swap(block - 1)) return false;
  return true;
}

Matrix Placement::feedback_of_one(Index block) {
  const double pole = schur_.eigenvalue(block).real();
  const Matrix g = rows_of(block);
  return g.transpose() * (pole - take_nearest(reals_, pole).real()) / g.squaredNorm();
}

Matrix Placement::feedback_of_two(Index block, std::complex<double>& first) {
  const Index row = schur_.first_row(block);
  const std::complex<double> pole = schur_.eigenvalue(block);
  std::complex<double> second;
  if (pairs_.empty()) {
    first = take_nearest(reals_, pole);
    second = take_nearest(reals_, pole);
  } else {
    first = take_nearest(pairs_, pole);
    second = std::conj(first);
  }
  const double trace = (first + second).real(), determinant = (first * second).real();
  const Eigen::Matrix2d T = schur_.T().block<2, 2>(row, row);
  const Matrix g = rows_of(block);
  const double size_1 = g.row(0).norm(), size_2 = g.row(1).norm();
  Matrix feedback;
  if (size_2 > unreached_) {
    const Eigen::Matrix2d M = nearest_with_poles(T, size_2 / size_1, trace, determinant);
    feedback = g.row(1).transpose() * (T.row(1) - M.row(1)) / (size_2 * size_2);
    feedback += g.row(0).transpose() * (T.row(0) - M.row(0)) / (size_1 * size_1);
  } else {
    const Eigen::Matrix2d M = first_row_with_poles(T, trace, determinant);
    feedback = g.row(0).transpose() * (T.row(0) - M.row(0)) / (size_1 * size_1);
  }
  return feedback;
}

}  // namespace

Poles poles_of(const Matrix& A) {
  Poles poles;
  const Vector size = balance(A);
  const SchurBlocks schur(size.cwiseInverse().asDiagonal() * A * size.asDiagonal());
  for (Index block = 0; block < schur.count(); ++block) {
    const std::complex<double> pole = schur.eigenvalue(block);
    poles.push_back(pole);
    if (schur.size(block) == 2) poles.push_back(std::conj(pole));
  }
  return poles;
}

std::variant<PolePlacement, Verdict> place_poles(const Matrix& A, const Matrix& B,
                                                 const Poles& wanted) {
  assert(A.rows() == A.cols() && B.rows() == A.rows() && A.allFinite() && B.allFinite());
  assert(static_cast<Index>(wanted.size()) == A.rows() && is_self_conjugate(wanted));
  const Vector size = balance(A), inverse = size.cwiseInverse();
  auto result =
      Placement(inverse.asDiagonal() * A * size.asDiagonal(), inverse.asDiagonal() * B, wanted)
          .run();
  if (auto* placement = std::get_if<PolePlacement>(&result))
    placement->gain *= inverse.asDiagonal();
  return result;
}

}  // namespace reident::identification
