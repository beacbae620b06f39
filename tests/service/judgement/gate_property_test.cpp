// What the gate promises of runs that differ by chance, and of those that do not, on many seeds.
#include <functional>

#include <gtest/gtest.h>

#include "identification/simulation/free_run.hpp"
#include "identification/simulation/scores.hpp"
#include "identification/statistics/comparison.hpp"
#include "service/judgement/gate.hpp"
#include "tests/support/systems.hpp"

namespace reident::gate_property_test {
namespace {

using identification::Index;
using identification::Matrix;
using identification::Record;
using identification::StateSpaceModel;
using test::Noise;

constexpr Index rows = 1800;
constexpr int trials = 1000;

struct Trial {
  StateSpaceModel champion;
  Record validation;  // of a plant that is not quite the champion, under coloured disturbances
};

Matrix disturbance(Noise& noise, double deviation) {
  Matrix values(rows, 1);
  double value = 0;
  for (Index k = 0; k < rows; ++k) {
    value = 0.8 * value + 0.6 * noise.normal();
    values(k, 0) = deviation * value;
  }
  return values;
}

StateSpaceModel perturbed(StateSpaceModel model, Noise& noise, double share) {
  for (Matrix* matrix : {&model.B, &model.C, &model.D})
    for (double& entry : matrix->reshaped()) entry *= 1 + share * noise.normal();
  return model;
}

Trial trial(Noise& noise) {
  Trial result;
  const StateSpaceModel plant = test::random_system(noise, 3, 2, 1, 0.9);
  result.validation = test::excited(plant, noise, rows, 0);
  result.champion = perturbed(plant, noise, 0.05);
  const double size = std::sqrt(result.validation.y.squaredNorm() / double(rows));
  result.validation.y += disturbance(noise, 0.1 * size);
  return result;
}

/// The gate's decision about the candidate, all but the comparison being as good as can be.
Outcome outcome(const Trial& one, const StateSpaceModel& candidate) {
  const Record& record = one.validation;
  const Matrix run = free_run(candidate, record, record.all());
  const Matrix of_champion = free_run(one.champion, record, record.all());
  Evidence evidence;
  evidence.well_formed = evidence.validation_moves = true;
  evidence.mrse_percent = identification::score(record.y, run).mrse();
  evidence.fit_percent = 90;
  evidence.mean.sure_percent = 80;
  evidence.window_end = 1000;
  EquipmentConfig limits;
  limits.margin_percent = 2;
  limits.max_mrse_percent = 1e6;
  const auto paired = identification::compare_runs(record.y, of_champion, run, {{0, rows}},
                                                   limits.confidence_percent / 100,
                                                   identification::Stationarity::stationary);
  Evidence::Comparison comparison;
  comparison.rows = rows;
  comparison.mrse_percent = evidence.mrse_percent;
  comparison.rival_mrse_percent = identification::score(record.y, of_champion).mrse();
  comparison.noise_percent = identification::noise_percent(record.y, run, {{0, rows}});
  if (paired) comparison.sure_percent = 100 * paired->low;
  evidence.champion = Evidence::Champion{1, 0, comparison, std::nullopt};
  return decide(evidence, limits).outcome;
}

int promoted(const std::function<StateSpaceModel(const Trial&, Noise&)>& candidate) {
  Noise noise(61);
  int count = 0;
  for (int i = 0; i < trials; ++i) {
    const Trial one = trial(noise);
    count += outcome(one, candidate(one, noise)) == Outcome::approved;
  }
  return count;
}

TEST(GateProperty, ACandidateEqualToTheChampionIsNeverPromoted) {
  EXPECT_EQ(promoted([](const Trial& one, Noise&) { return one.champion; }), 0);
}

TEST(GateProperty, TheChampionPlusNoiseIsPromotedInFewerThanOneOfAHundredTrials) {
  // The plant's disturbances hide what tiny changes of the matrices do to the error.
  EXPECT_LT(promoted([](const Trial& one, Noise& noise) {
              return perturbed(one.champion, noise, 0.002);
            }),
            trials / 100);
}

TEST(GateProperty, AModelWhoseErrorIsHalfAsLargeIsPromotedInMoreThanNineteenOfTwentyTrials) {
  // Candidates between the champion and the plant: what of them errs half as much is counted.
  // Nearly half of the disturbances changes from row to row, as sensors' noise does.
  Noise noise(62);
  int better = 0, approved = 0;
  for (int i = 0; better < trials && i < 20 * trials; ++i) {
    Trial one = trial(noise);
    const StateSpaceModel candidate = one.champion;
    // The champion has lost its gain; the candidate still has it.
    one.champion.C *= 0.6 + 0.3 * noise.uniform();
    one.champion.D *= one.champion.C(0, 0) / candidate.C(0, 0);
    const Record& record = one.validation;
    const double was = score_free_run(one.champion, record, record.all(), record.all()).mrse();
    const double is = score_free_run(candidate, record, record.all(), record.all()).mrse();
    if (!(is < 0.5 * was)) continue;
    ++better;
    approved += outcome(one, candidate) == Outcome::approved;
  }
  EXPECT_EQ(better, trials);
  EXPECT_GT(approved, trials * 95 / 100);
}

}  // namespace
}  // namespace reident::gate_property_test
