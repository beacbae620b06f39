#include "identification/fit/static_regression.hpp"

#include "identification/numerics/decompositions.hpp"

namespace reident::identification {

StateSpaceModel static_regression(const Record& record, RowRange rows) {
  const auto u = record.u.middleRows(rows.begin, rows.size());
  const auto y = record.y.middleRows(rows.begin, rows.size());
  StateSpaceModel model;
  model.A = Matrix(0, 0);
  model.B = Matrix(0, u.cols());
  model.C = Matrix(y.cols(), 0);
  model.u0 = u.colwise().mean();
  model.y0 = y.colwise().mean();
  model.period_s = record.period_s;
  const Matrix moves = u.rowwise() - model.u0.transpose();
  const Vector deviation = (moves.colwise().squaredNorm() / double(rows.size())).cwiseSqrt();
  const Vector scale = (deviation.array() > 0).select(deviation.cwiseInverse(), 0.0);
  const Matrix scaled = moves * scale.asDiagonal();
  const Matrix centred = y.rowwise() - model.y0.transpose();
  const Matrix gram = scaled.transpose() * scaled;
  const Matrix products = scaled.transpose() * centred;
  model.D = solve_least_norm(gram, products).transpose() * scale.asDiagonal();
  return model;
}

}  // namespace reident::identification
