#include "identification/statistics/level_shift.hpp"

#include <cmath>
#include <utility>

#include "identification/numerics/decompositions.hpp"
#include "identification/statistics/correlation.hpp"

namespace reident::identification {
namespace {

constexpr Index least_judged = 60;
constexpr double least_deviations = 2, certain_errors = 6;
constexpr double beside_drift = 0.8;  // of what a straight line leaves

/// Sum of squares that a straight line leaves of centred values.
double left_of_line(const Vector& values) {
  const Vector line = Vector::LinSpaced(values.size(), -1, 1);
  return values.squaredNorm() - std::pow(line.dot(values), 2) / line.squaredNorm();
}

}  // namespace

std::optional<LevelShift> level_shift(const Vector& values, const Matrix& columns,
                                      const std::vector<RowRange>& segments) {
  const Index rows = values.size(), margin = rows / 10;
  if (rows < least_judged) return std::nullopt;
  const Matrix moves = columns.rowwise() - columns.colwise().mean();
  Vector left = values.array() - values.mean();
  left -= moves * solve_pivoted_qr(moves, Matrix(left));
  const double of_line = left_of_line(left);
  Index row = 0;
  double most = 0, sum = 0;  // of the rows before
  for (Index k = 1; k < rows; ++k) {
    sum += left(k - 1);
    if (k < margin || rows - k < margin) continue;
    const double explained = sum * sum / (double(k) * double(rows - k));
    if (explained > most) most = explained, row = k;
  }
  if (row == 0) return std::nullopt;
  const double before = left.head(row).mean(), behind = left.tail(rows - row).mean();
  left.head(row).array() -= before;
  left.tail(rows - row).array() -= behind;
  if (left.squaredNorm() > beside_drift * of_line) return std::nullopt;
  const double size = behind - before, deviation = std::sqrt(left.squaredNorm() / double(rows));
  Series rest(std::move(left), segments);
  const double error = deviation * std::sqrt(correlated_rows(rest) * double(rows) /
                                             (double(row) * double(rows - row)));
  if (!(std::abs(size) > least_deviations * deviation && std::abs(size) > certain_errors * error))
    return std::nullopt;
  return LevelShift{row, size};
}

}  // namespace reident::identification
