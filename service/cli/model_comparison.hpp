// What two models do, in figures that do not depend on the basis of their states.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <vector>

#include "service/model/model_version.hpp"

namespace reident::cli {

struct Pole {
  std::complex<double> value;  // eigenvalue of A
  double time_constant_s = 0;  // of the decay, infinite on the unit circle
  double frequency_hz = 0;     // of the oscillation, at most half of the sample rate
};

/// The slowest first; a complex pair once, with the positive imaginary part.
std::vector<Pole> poles_of(const identification::StateSpaceModel& model);

/// Outputs (rows) after a unit step of input `input`, less those before it, at each of the times
/// [s]: the values of the sample at or before it.
identification::Matrix step_response(const identification::StateSpaceModel& model,
                                     identification::Index input,
                                     const std::vector<double>& times_s);

/// Times in steps of about 1, 2, 5, 10, ... sample periods at which the steps of both models are
/// worth a look: from the first sample until the slower one has settled to 1 %, or 1000 samples.
std::vector<double> step_times(const identification::StateSpaceModel& a,
                               const identification::StateSpaceModel& b);

/// One output's answer to one input of either model.
struct Channel {
  std::string input, output;
  std::optional<double> gain_a, gain_b;
  std::vector<double> steps_a, steps_b;  // at the times of the comparison; empty without the input
};

struct ModelComparison {
  std::vector<Pole> poles_a, poles_b;
  std::vector<double> times_s;
  std::vector<Channel> channels;
  /// "only 3 has ...", a sentence for each difference; empty where the inputs are the same.
  std::vector<std::string> input_differences;
};

/// Both well formed and of the same outputs; the numbers name them in the sentences.
ModelComparison compare_models(const EquipmentModel& a, std::int64_t number_a,
                               const EquipmentModel& b, std::int64_t number_b);

}  // namespace reident::cli
