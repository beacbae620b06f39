#include "identification/statistics/shifts.hpp"

#include <cmath>

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

struct Step {
  Shift shift;
  Vector left;
};

/// The step of the factor by which the values follow the carrier that explains most of them,
/// where it is large and certain.
std::optional<Step> step_of(Vector values, const Vector& carrier, Shift::Of of,
                            const std::vector<RowRange>& segments) {
  const Index rows = values.size(), margin = rows / 10;
  const double all_products = values.dot(carrier), all_squares = carrier.squaredNorm();
  Index row = 0;
  double most = 0, products = 0, squares = 0;  // of the rows before
  double before = 0, behind = 0, squares_before = 0;
  for (Index k = 1; k < rows; ++k) {
    products += values(k - 1) * carrier(k - 1);
    squares += carrier(k - 1) * carrier(k - 1);
    const double rest = all_squares - squares;
    if (k < margin || rows - k < margin || !(squares > 0 && rest > 0)) continue;
    const double other = all_products - products;
    const double explained = products * products / squares + other * other / rest;
    if (!(explained > most)) continue;
    most = explained, row = k;
    before = products / squares, behind = other / rest, squares_before = squares;
  }
  if (row == 0) return std::nullopt;
  values.head(row) -= before * carrier.head(row);
  values.tail(rows - row) -= behind * carrier.tail(rows - row);
  const double size = behind - before, squares_behind = all_squares - squares_before;
  const double deviation = std::sqrt(values.squaredNorm() / double(rows));
  const Vector products_left = values.cwiseProduct(carrier);
  Series series(products_left, segments);
  const double error =
      std::sqrt(products_left.squaredNorm() / double(rows) * correlated_rows(series) *
                (double(row) / (squares_before * squares_before) +
                 double(rows - row) / (squares_behind * squares_behind)));
  if (!(std::abs(size) * std::sqrt(all_squares / double(rows)) > least_deviations * deviation &&
        std::abs(size) > certain_errors * error))
    return std::nullopt;
  return Step{{of, row, size}, std::move(values)};
}

}  // namespace

std::optional<Shift> shift_of(const Vector& values, const Vector& y_hat, const Matrix& columns,
                              const std::vector<RowRange>& segments) {
  if (values.size() < least_judged) return std::nullopt;
  const Matrix moves = columns.rowwise() - columns.colwise().mean();
  Vector left = values.array() - values.mean();
  left -= moves * solve_pivoted_qr(moves, Matrix(left));
  const Vector centred = y_hat.array() - y_hat.mean();
  const auto gain = step_of(left, centred, Shift::Of::gain, segments);
  const auto mean = step_of(left, Vector::Ones(left.size()), Shift::Of::mean, segments);
  const double of_gain = gain ? gain->left.squaredNorm() : left.squaredNorm();
  if (mean && mean->left.squaredNorm() < of_gain &&
      mean->left.squaredNorm() <= beside_drift * left_of_line(left))
    return mean->shift;
  return gain ? std::optional(gain->shift) : std::nullopt;
}

}  // namespace reident::identification
