#include "identification/statistics/betting.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace reident::identification::betting_test {
namespace {

constexpr Index cycle = 4;

ScoreSeries series(Vector scores) {
  return {std::move(scores), 1, cycle};
}

double wealth(const Vector& scores) {
  return Bet(series(scores)).log_wealth();
}

/// A bet on few scores that are taken for independent.
Bet bet_on_independent(Vector scores) {
  return Bet({std::move(scores), 1, cycle, 1});
}

TEST(Betting, WithoutScoresNothingIsWonOrLost) {
  EXPECT_EQ(wealth(Vector()), 0);
  EXPECT_EQ(Bet(series(Vector())).lower_mean(1), -1);
}

TEST(Betting, OneScoreOfOneDoublesTheLargestBet) {
  // The bets 1, 1/2, ... have shares of 16/31, 8/31, ...
  const double expected = std::log((16 * 2 + 8 * 1.5 + 4 * 1.25 + 2 * 1.125 + 1.0625) / 31);
  EXPECT_NEAR(bet_on_independent(Vector::Ones(1)).log_wealth(), expected, 1e-12);
}

TEST(Betting, TheLargestBetIsLostWithAScoreOfMinusOneAndTheOthersAreNot) {
  Vector scores(2);
  scores << -1, 1;
  const double rest = (8 * 0.75 + 4 * 0.9375 + 2 * 0.984375 + 0.99609375) / 31;
  EXPECT_NEAR(bet_on_independent(scores).log_wealth(), std::log(rest), 1e-12);
}

TEST(Betting, ScoresThatCountAsHalfGrowTheLogarithmHalfAsFast) {
  const Vector scores = Vector::Constant(24, 0.5);
  const auto wealth_where = [&](double assumed) {
    return Bet({scores, 1, cycle, assumed}).log_wealth();
  };
  EXPECT_NEAR(wealth_where(2) / wealth_where(1), 0.5, 0.05);
}

TEST(Betting, TheLowerEndIsWhereTheWealthReachesTheThreshold) {
  std::mt19937_64 random(3);
  std::normal_distribution<> normal;
  Vector scores(60);
  for (double& score : scores) score = std::tanh(0.4 + 0.3 * normal(random));
  const Bet bet(series(scores));
  const double low = bet.lower_mean(3);
  EXPECT_NEAR(bet.log_wealth(low), 3, 1e-6);
  EXPECT_LT(low, scores.mean());
}

TEST(Betting, DependenceIsThatOfACycleUntilItWasMeasured) {
  EXPECT_NEAR(Bet(series(Vector::Constant(1, 0.2))).dependence(), 4 - 3.0 / 32, 1e-12);
  EXPECT_NEAR(Bet(series(Vector::Constant(16, 0.2))).dependence(), 2.5, 1e-12);
  EXPECT_NEAR(Bet(series(Vector::Constant(32, 0.2))).dependence(), 1, 1e-12);
}

TEST(Betting, DependenceOfScoresThatComeInPairsIsTwoAtLeast) {
  std::mt19937_64 random(5);
  std::normal_distribution<> normal;
  Vector scores(4000);
  for (Index i = 0; i < scores.size(); i += 2)
    scores(i) = scores(i + 1) = std::tanh(0.5 * normal(random));
  EXPECT_GT(Bet(series(scores)).dependence(), 2);
  EXPECT_LT(Bet(series(scores)).dependence(), 5);  // the largest ratio of many, and its uncertainty
}

TEST(Betting, DependenceDoesNotRestOnWhereTheMeansBegin) {
  std::mt19937_64 random(6);
  std::normal_distribution<> normal;
  Vector scores(61);
  for (double& score : scores) score = std::tanh(0.5 * normal(random));
  for (Index n = 48; n < 60; ++n) {
    const double now = Bet(series(scores.head(n))).dependence();
    EXPECT_NEAR(Bet(series(scores.head(n + 1))).dependence() / now, 1, 0.15) << n;
  }
}

TEST(Betting, DependenceIsWhatIsAssumedUntilItWasMeasured) {
  ScoreSeries scores = series(Vector::Constant(31, 0.2));
  scores.assumed = 2.5;
  EXPECT_EQ(Bet(scores).dependence(), 2.5);
  scores.scores = Vector::Constant(32, 0.2);
  EXPECT_EQ(Bet(scores).dependence(), 1);
}

using Random = std::mt19937_64;
/// Score of the next block.
using Source = std::function<double(Random&)>;

struct Kind {
  std::string name;
  std::function<Source(Random&)> make;
  double equal_share;  // sequences in which equal models may be told apart
};

double normal(Random& random) {
  return std::normal_distribution<>()(random);
}

/// (b - a) / (b + a) of the mean squares of two noises.
double of_noise(Random& random, int degrees_of_freedom, double ratio) {
  std::chi_squared_distribution<> square(degrees_of_freedom);
  const double a = square(random), b = ratio * ratio * square(random);
  return (b - a) / (b + a);
}

/// Autoregressive, with the deviation 0.4; `mean` is the logarithm of the ratio.
Source slow(Random& random, double rho, double mean) {
  return [x = 0.4 * normal(random), rho, mean](Random& next) mutable {
    x = rho * x + 0.4 * std::sqrt(1 - rho * rho) * normal(next);
    return std::tanh(mean + x);
  };
}

/// Stretches of 3 to 13 blocks in which one of the two errs 2.2 times as much as the other.
Source bursty(double mean) {
  return [left = 0, sign = 1.0, mean](Random& next) mutable {
    std::uniform_real_distribution<> uniform;
    if (left == 0 && uniform(next) < 0.03) {
      left = 3 + static_cast<int>(10 * uniform(next));
      sign = uniform(next) < 0.5 ? -1 : 1;
    }
    const double burst = left > 0 ? 0.8 * sign : 0;
    if (left > 0) --left;
    return std::tanh(mean + burst + 0.1 * normal(next));
  };
}

/// One errs less in one half of the cycle, the other one in the other half.
Source alternating(Random& random, double mean) {
  const double size = 0.8 * std::uniform_real_distribution<>()(random);
  return [block = 0, size, mean](Random& next) mutable {
    return std::tanh(mean + (block++ % cycle < cycle / 2 ? size : -size) + 0.2 * normal(next));
  };
}

std::vector<Kind> kinds(double ratio) {
  const double mean = std::log(ratio);
  return {{"noise of 10 degrees of freedom",
           [=](Random&) { return [=](Random& next) { return of_noise(next, 10, ratio); }; }, 0.05},
          {"noise of 2 degrees of freedom",
           [=](Random&) { return [=](Random& next) { return of_noise(next, 2, ratio); }; }, 0.05},
          {"alternating within the cycle",
           [=](Random& random) { return alternating(random, mean); }, 0.05},
          {"bursts of 3 to 13 blocks", [=](Random&) { return bursty(mean); }, 0.05},
          {"autoregressive, 0.5 (d = 3)", [=](Random& random) { return slow(random, 0.5, mean); },
           0.05},
          {"autoregressive, 0.6 (d = 4)", [=](Random& random) { return slow(random, 0.6, mean); },
           0.05},
          {"autoregressive, 0.9 (d = 19)", [=](Random& random) { return slow(random, 0.9, mean); },
           0.3}};
}

/// Blocks until the wealth exceeds the threshold; one more than `blocks` where it never does. It is
/// looked at after every block, and from the 40th on after every fourth.
Index blocks_until(const Source& source, Random& random, Index blocks, double log_threshold) {
  Vector scores(blocks);
  for (Index n = 0; n < blocks; ++n) {
    scores(n) = source(random);
    if (n >= 40 && n % 4 != 0) continue;
    if (wealth(scores.head(n + 1)) > log_threshold) return n + 1;
  }
  return blocks + 1;
}

TEST(Betting, EqualModelsAreRarelyEverToldApartHoweverOftenOneLooks) {
  const char* asked = std::getenv("REIDENT_SEQUENCES");  // 10000 for the table of METHOD.md
  const int sequences = asked ? std::atoi(asked) : 1000;
  constexpr Index blocks = 200;
  for (const Kind& kind : kinds(1)) {
    Random random(17);
    int told = 0;
    for (int i = 0; i < sequences; ++i)
      told += blocks_until(kind.make(random), random, blocks, std::log(1 / 0.05)) <= blocks;
    printf("| %s | %.2f %% |\n", kind.name.c_str(), 100.0 * told / sequences);
    EXPECT_LE(told, kind.equal_share * sequences) << kind.name;
  }
}

TEST(Betting, ABetterModelIsToldSooner) {
  constexpr int sequences = 200;
  constexpr Index blocks = 1200;
  for (const double ratio : {1.25, 4.0 / 3, 1.5, 2.0, 3.0})
    for (const Kind& kind : kinds(ratio)) {
      Random random(19);
      std::vector<Index> needed;
      for (int i = 0; i < sequences; ++i)
        needed.push_back(blocks_until(kind.make(random), random, blocks, std::log(1 / 0.05)));
      std::nth_element(needed.begin(), needed.begin() + sequences / 2, needed.end());
      const double cycles = double(needed[sequences / 2]) / cycle;
      printf("%.2f | %s | %.1f\n", ratio, kind.name.c_str(), cycles);
      if (ratio > 1.3 && kind.name.find("noise of 10") == 0) {
        EXPECT_LE(cycles, 20) << ratio;
      }
    }
}

}  // namespace
}  // namespace reident::identification::betting_test
