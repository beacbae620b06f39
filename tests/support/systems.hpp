// Known systems and the records that they would leave: what identification is judged against.
#pragma once

#include <cstdint>
#include <random>

#include "identification/samples/record.hpp"
#include "identification/simulation/state_space.hpp"

namespace reident::test {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::StateSpaceModel;
using identification::Vector;

/// Normal deviates by Box and Muller over a fixed generator: the same on every machine, which
/// std::normal_distribution is not.
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : generator_(seed) {}
  double uniform();  // in (0, 1)
  double normal();
  Matrix normal(Index rows, Index columns);

 private:
  std::mt19937_64 generator_;
};

/// The numbers in [-0.5, 0.5) that Octave gives with
/// s = 1; z = zeros(rows, columns);
/// for k = 1:rows, for j = 1:columns
///   s = mod(16807*s, 2147483647); z(k,j) = s/2147483647 - 0.5;
/// end, end
Matrix generated(Index rows, Index columns);

/// A stable system of real and complex poles with moduli in [0.3, max_modulus], inputs and outputs
/// of comparable gain, and an operating point of zero.
StateSpaceModel random_system(Noise& noise, Index order, Index inputs, Index outputs,
                              double max_modulus = 0.95);

/// Outputs of the model from the initial state `x0` (rows x p).
Matrix simulated(const StateSpaceModel& model, const Matrix& u, const Vector& x0);

/// A record of `rows` rows with white inputs and output noise whose deviation is `noise_share` of
/// each output's own.
Record excited(const StateSpaceModel& model, Noise& noise, Index rows, double noise_share);

/// The record without the rows [begin, end): its second part is a segment of its own.
Record with_gap(const Record& record, Index begin, Index end);

/// D, C B, C A B, ... side by side (p x m count).
Matrix markov_parameters(const StateSpaceModel& model, Index count);

/// || a - b || / || b || over the first 40 Markov parameters.
double markov_distance(const StateSpaceModel& a, const StateSpaceModel& b);

/// Largest distance from a pole of `b` to the nearest pole of `a`.
double pole_distance(const StateSpaceModel& a, const StateSpaceModel& b);

}  // namespace reident::test
