// Judges a model on rows that it was not identified from, converts it to continuous time to compare
// it with physics, and samples it again for a simulator of another step.
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <random>
#include <variant>

#include "identification/correction/pole_placement.hpp"
#include "identification/search/identify.hpp"
#include "identification/simulation/continuous.hpp"
#include "identification/simulation/free_run.hpp"
#include "identification/statistics/diagnostics.hpp"

using namespace reident::identification;

int main() {
  // A panel with time constants of 20 s and 300 s, sampled every 5 s: dx/dt = A x + B u, y = C x.
  ContinuousModel truth{Matrix::Zero(2, 2), Matrix(2, 1),    Matrix::Ones(1, 2),
                        Matrix::Zero(1, 1), Vector::Zero(1), Vector::Zero(1)};
  truth.A.diagonal() << -1 / 20.0, -1 / 300.0;
  truth.B << 0.5 / 20, 1.5 / 300;
  const StateSpaceModel plant = to_discrete(truth, 5);
  constexpr Index rows = 6000, seen = 4000;
  std::mt19937_64 generator(3);
  const auto uniform = [&generator] { return double(generator() >> 11) * 0x1p-53; };
  Record record = contiguous_record(5, Matrix(rows, 1), Matrix(rows, 1));
  Vector x = Vector::Zero(2);
  for (Index k = 0; k < rows; ++k) {
    record.u(k, 0) = k % 30 == 0 ? 100 * uniform() : record.u(k - 1, 0);
    record.y(k, 0) = (plant.C * x)(0) + uniform() - 0.5;  // noise of the sensor
    x = plant.A * x + plant.B * record.u.row(k).transpose();
    x(1) += uniform() - 0.5;  // what no input explains
  }

  const IdentifyResult result = identify(record, {0, seen}, {});
  if (const auto* verdict = std::get_if<Verdict>(&result)) {
    std::fprintf(stderr, "no model: %s\n", verdict->reason.c_str());
    return 1;
  }
  const auto& found = std::get<Identified>(result);

  const Diagnostics judged = diagnose(found.model, record, record.all(), {seen, rows}, found.x0);
  std::printf("error %.2f %%", judged.free_run.mrse());
  if (judged.interval)
    std::printf(", with 95 %% confidence %.2f to %.2f %%", judged.interval->low(0),
                judged.interval->high(0));
  std::printf("\nresiduals %s; %s of the input is left in them\n",
              judged.whiteness[0].portmanteau.white() ? "white" : "not white",
              judged.free_run_inputs[0].correlation.significant() ? "something" : "nothing");
  for (const PredictionScore& prediction : judged.predictions)
    std::printf("%3td steps ahead: error %.2f %%\n", prediction.steps, prediction.score.mrse());

  const auto converted = to_continuous(found.model);
  if (const auto* verdict = std::get_if<Verdict>(&converted)) {
    std::fprintf(stderr, "no continuous time: %s\n", verdict->reason.c_str());
    return 1;
  }
  const auto& continuous = std::get<ContinuousModel>(converted);
  for (const std::complex<double>& pole : poles_of(continuous.A))
    std::printf("time constant %.1f s\n", -1 / pole.real());

  // The response to a step of 1 from the operating point: every fifth sample at 1 s is one at 5 s.
  const auto step_response = [](const StateSpaceModel& model, Index samples) -> Matrix {
    const Matrix u = Matrix::Constant(samples, 1, model.u0(0) + 1);
    const Record step = contiguous_record(model.period_s, u, Matrix::Zero(samples, 1));
    return free_run(model, step, step.all(), Vector::Zero(model.order())).array() - model.y0(0);
  };
  const Matrix coarse = step_response(found.model, 200);
  const Matrix fine = step_response(to_discrete(continuous, 1), 1000);
  double difference = 0;
  for (Index k = 0; k < 200; ++k)
    difference = std::max(difference, std::abs(coarse(k, 0) - fine(5 * k, 0)));
  std::printf("step response after 995 s %.3f (true: %.3f); sampled at 1 s it differs by %.0e\n",
              coarse(199, 0), step_response(plant, 200)(199, 0), difference);
}
