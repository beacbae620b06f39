// A record with a hole, and what it would be without noise.
#pragma once

#include <cmath>

#include "identification/samples/record.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/simulation/state_space.hpp"
#include "tests/support/systems.hpp"

namespace reident::test {

/// An integrator and a fast state, measured with noise of 0.1; rows 400 to 403 are missing.
struct HoledRecord {
  StateSpaceModel model{(Matrix(2, 2) << 1, 0, 0, 0.2).finished(),
                        (Matrix(2, 1) << 0.01, 1).finished(),
                        Matrix::Ones(1, 2),
                        Matrix::Zero(1, 1),
                        {},
                        Vector::Zero(1),
                        Vector::Zero(1),
                        1};
  Matrix y;  // without noise
  Record record;

  HoledRecord(Noise& noise, const Matrix& u) {
    y = simulated(model, u, Vector::Zero(2));
    record = with_gap(identification::contiguous_record(1, u, y + 0.1 * noise.normal(u.rows(), 1)),
                      400, 404);
  }
  double error_behind_the_hole() const {
    const Matrix run = free_run(model, record, record.all(), Vector::Zero(2));
    const Index rows = record.rows() - 400;
    return (run.bottomRows(rows) - y.bottomRows(rows)).norm() / std::sqrt(double(rows));
  }
};

}  // namespace reident::test
