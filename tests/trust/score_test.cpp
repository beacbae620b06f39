#include "tests/trust/score.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <gmock/gmock.h>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference/reference_telemetry.hpp"

namespace reident::trust::score_test {
namespace {

constexpr Duration second = 1'000'000'000;
constexpr Duration period = 8 * second;
constexpr Duration orbit = 750 * period;
constexpr storage::Time start = 10'000 * orbit;
constexpr double pole = 0.9;

/// x[k+1] = pole x[k] + (1 - pole) gain u[k], y = 10 + x: the gain from input to output is `gain`.
EquipmentModel model_of(double gain) {
  EquipmentModel model;
  model.spacecraft = "REFERENCE";
  model.equipment = "BDR";
  model.inputs = {{"I_BDRIN1", "A"}};
  model.outputs = {{"I_BDROUT", "A"}};
  auto& dynamics = model.dynamics;
  dynamics.A = identification::Matrix::Constant(1, 1, pole);
  dynamics.B = identification::Matrix::Constant(1, 1, (1 - pole) * gain);
  dynamics.C = identification::Matrix::Ones(1, 1);
  dynamics.D = identification::Matrix::Zero(1, 1);
  dynamics.u0 = identification::Vector::Zero(1);
  dynamics.y0 = identification::Vector::Constant(1, 10);
  dynamics.period_s = 8;
  model.sample_hold_ns = 3 * period;
  return model;
}

/// 120 orbits of an equipment whose gain is 2 and becomes `gain_after` at the 40th, steadily until
/// the orbit `grown_at`.
class Score : public testing::Test {
 protected:
  static constexpr std::int64_t orbits = 120, change_orbit = 40;

  explicit Score(double gain_after = 2, std::int64_t grown_at = change_orbit) {
    spacecraft_.name = "REFERENCE";
    equipment_.name = "BDR";
    equipment_.inputs = {"I_BDRIN1"};
    equipment_.outputs = {"I_BDROUT"};
    equipment_.sample_period = period;
    equipment_.sample_hold = 3 * period;
    equipment_.window = 8 * orbit;
    double x = 2;
    for (storage::Time time = start; time < end_; time += period) {
      const double grown = std::clamp((double(time - start) / orbit - change_orbit) /
                                          std::max(1e-9, double(grown_at - change_orbit)),
                                      0.0, 1.0);
      const double gain = 2 + grown * (gain_after - 2);
      const double u = 1 + std::sin(2 * M_PI * double((time - start) % orbit) / orbit);
      const auto sample = [](const char* name, double value) {
        return storage::Sample{satcs::parameter_id(name), storage::Quality::good, value};
      };
      truth_.append(time, std::array{sample("I_BDRIN1", u), sample("I_BDROUT", 10 + x)});
      simulated_.append(time, std::array{sample("I_BDROUT", 10 + 0.5 * x)});
      x = pole * x + (1 - pole) * gain * u;
    }
  }

  Truth truth() const {
    return {truth_, simulated_, spacecraft_, equipment_, {start, end_}, orbit};
  }
  static storage::Time at(std::int64_t n) { return start + n * orbit; }
  static Tenure tenure(std::int64_t since_orbit, std::int64_t version, double gain) {
    return {at(since_orbit), version, model_of(gain)};
  }
  /// The hand-written model until the 5th orbit, then a version of the gain 2.
  static std::vector<Tenure> good_service() { return {{start, 0, {}}, tenure(5, 1, 2)}; }

  static ChangeScore only(const std::vector<ChangeScore>& scores) {
    EXPECT_EQ(scores.size(), 1U);
    return scores.front();
  }
  ChangeScore score(const std::vector<Tenure>& tenures, double oracle_gain,
                    const std::vector<Tenure>& versions = {}) const {
    return only(score_changes(
        truth(), tenures, version_curves(truth(), versions), {change_},
        [=](auto) { return model_of(oracle_gain); }, [](auto) { return true; }));
  }

  const storage::Time end_ = at(orbits);
  TrueChange change_{"efficiency_drift", at(change_orbit), at(change_orbit)};

 private:
  const std::vector<storage::ParameterDescriptor> descriptors_ =
      satcs::reference::telemetry_descriptors("REFERENCE");
  KnownSeries truth_{descriptors_, {"I_BDRIN1", "I_BDROUT"}};
  KnownSeries simulated_{descriptors_, {"I_BDROUT"}};
  SpacecraftConfig spacecraft_;
  EquipmentConfig equipment_;
};

class ScoreOfAChange : public Score {
 protected:
  ScoreOfAChange() : Score(4) {}
};

class ScoreOfAgeing : public Score {
 protected:
  ScoreOfAgeing() : Score(4, 80) { change_.end = at(80); }
};

TEST_F(Score, RegretIsTheChampionsErrorOverThatOfTheBestVersionOfThen) {
  // Version 2 errs half as much and exists for all but the first 10 orbits of the champion's
  // tenure.
  const std::vector<Tenure> versions = {tenure(5, 1, 2.4), tenure(15, 2, 2.2)};
  const auto curves = version_curves(truth(), versions);
  const std::vector<Tenure> served = {{start, 0, {}}, versions[0]};
  const std::int64_t judged = orbits - least_judged_orbits - 5 + 1;
  const double all_but_ten = double(judged - 10) / double(judged);
  EXPECT_NEAR(*regret(truth(), served, curves), std::pow(2, all_but_ten), 0.02);
  EXPECT_NEAR(*regret(truth(), {{start, 0, {}}, versions[1]}, curves), 1, 1e-12);
  EXPECT_EQ(regret(truth(), {{start, 0, {}}}, curves), std::nullopt);
}

TEST_F(Score, CountsAVersionThatIsWorseThanWhatItReplacedAsWrong) {
  std::vector<Tenure> tenures = good_service();
  tenures.push_back(tenure(20, 2, 3));
  const auto publications = score_publications(truth(), tenures, {});
  ASSERT_EQ(publications.size(), 2U);
  EXPECT_FALSE(publications[0].wrong());
  EXPECT_TRUE(publications[1].wrong());
  EXPECT_NEAR(*publications[1].replaced_mrse_percent, 0, 0.1);
  EXPECT_GT(*publications[1].mrse_percent, 5);
  EXPECT_EQ(publications[1].judged_on, (storage::TimeRange{at(20), at(50)}));
}

TEST_F(Score, CountsAFirstVersionThatIsWorseThanTheHandWrittenModelAsWrong) {
  EXPECT_TRUE(score_publications(truth(), {{start, 0, {}}, tenure(5, 1, 3.5)}, {})[0].wrong());
  EXPECT_FALSE(score_publications(truth(), {{start, 0, {}}, tenure(5, 1, 2.5)}, {})[0].wrong());
}

TEST_F(Score, CountsAVersionThatRunsAwayAsWrong) {
  std::vector<Tenure> tenures = good_service();
  tenures.push_back(tenure(20, 2, 2));
  tenures.back().model->dynamics.A(0, 0) = 1.5;
  EXPECT_TRUE(score_publications(truth(), tenures, {})[1].wrong());
}

TEST_F(Score, ForgivesWhatNoSensorCouldShow) {
  std::vector<Tenure> tenures = good_service();
  tenures.push_back(tenure(20, 2, 2.01));
  const Publication publication = score_publications(truth(), tenures, {})[1];
  EXPECT_GT(*publication.mrse_percent, 1.1 * *publication.replaced_mrse_percent);
  EXPECT_FALSE(publication.wrong());
}

TEST_F(ScoreOfAChange, JudgesAVersionUntilTheNextStepAlone) {
  const std::vector<Tenure> tenures{{start, 0, {}}, tenure(5, 1, 2), tenure(30, 2, 3)};
  const auto publications = score_publications(truth(), tenures, {change_});
  EXPECT_EQ(publications[1].judged_on, (storage::TimeRange{at(30), at(change_orbit)}));
  EXPECT_TRUE(publications[1].wrong());  // although it is better after the change
  const std::vector<Tenure> late{{start, 0, {}}, tenure(5, 1, 2), tenure(38, 2, 3)};
  EXPECT_FALSE(score_publications(truth(), late, {change_})[1].mrse_percent);
}

TEST_F(ScoreOfAChange, FindsAChangeThatNobodyNoticed) {
  const ChangeScore change = score(good_service(), 4);
  EXPECT_TRUE(change.mattered);
  EXPECT_TRUE(change.missed());
  EXPECT_GT(change.orbits, 35);
}

TEST_F(ScoreOfAChange, FindsAChangeThatWasNoticedTooLate) {
  std::vector<Tenure> tenures = good_service();
  tenures.push_back(tenure(change_orbit + 25, 2, 4));
  EXPECT_TRUE(score(tenures, 4).missed());
  EXPECT_NEAR(double(score(tenures, 4).orbits), 25, 2);
}

TEST_F(ScoreOfAChange, CountsTheOrbitsUntilAGoodVersion) {
  std::vector<Tenure> tenures = good_service();
  tenures.push_back(tenure(change_orbit + 12, 2, 4));
  const ChangeScore change = score(tenures, 4);
  EXPECT_TRUE(change.mattered);
  EXPECT_FALSE(change.missed());
  EXPECT_NEAR(double(change.orbits), 12, 2);
}

TEST_F(ScoreOfAChange, DoesNotTakeABetterVersionForAGoodOne) {
  std::vector<Tenure> tenures = good_service();
  tenures.push_back(tenure(change_orbit + 12, 2, 3));
  EXPECT_TRUE(score(tenures, 4).missed());
}

TEST_F(ScoreOfAChange, FindsAChangeThatIsLostAgain) {
  std::vector<Tenure> tenures = good_service();
  tenures.push_back(tenure(change_orbit + 5, 2, 4));
  tenures.push_back(tenure(change_orbit + 10, 3, 2));
  EXPECT_TRUE(score(tenures, 4).missed());
}

TEST_F(ScoreOfAChange, TellsWhetherAVersionThatWasMadeInTimeWouldHaveFollowed) {
  const ChangeScore in_time = score(good_service(), 4, {tenure(change_orbit + 12, 2, 4)});
  EXPECT_TRUE(in_time.missed());
  EXPECT_NEAR(double(in_time.hindsight_orbits), 12, 2);
  EXPECT_FALSE(in_time.missed_in_hindsight());
  EXPECT_TRUE(score(good_service(), 4, {tenure(change_orbit + 30, 2, 4)}).missed_in_hindsight());
  EXPECT_TRUE(score(good_service(), 4).missed_in_hindsight());
}

TEST_F(ScoreOfAChange, DoesNotCountOrbitsWhoseTelemetryFaults) {
  const auto honest = [](storage::TimeRange range) { return range.begin >= at(change_orbit + 30); };
  const auto oracle = [](auto) { return model_of(4); };
  const ChangeScore change =
      only(score_changes(truth(), good_service(), {}, {change_}, oracle, honest));
  EXPECT_LT(change.orbits, 15);
  EXPECT_GT(change.orbits, 5);
}

TEST_F(ScoreOfAChange, LeavesAChangeOutThatAnOracleCannotFollowEither) {
  EXPECT_FALSE(score(good_service(), 2).mattered);
}

TEST_F(Score, LeavesAChangeOutThatMadeNoDifference) {
  const ChangeScore change = score(good_service(), 2);
  EXPECT_FALSE(change.mattered);
  EXPECT_FALSE(change.missed());
}

TEST_F(ScoreOfAgeing, CountsFromWhereTheOldChampionIsTooBad) {
  std::vector<Tenure> tenures = good_service();
  for (std::int64_t n = 45; n < 90; n += 5)
    tenures.push_back(tenure(n, n, 2 + 2 * std::min(1.0, double(n - change_orbit) / 40)));
  const auto oracle = [](storage::Time begin) {
    const double grown = double(begin + 4 * orbit - at(change_orbit)) / double(40 * orbit);
    return model_of(2 + 2 * std::min(1.0, grown));
  };
  const auto always = [](auto) { return true; };
  EXPECT_FALSE(only(score_changes(truth(), tenures, {}, {change_}, oracle, always)).missed());
  EXPECT_TRUE(only(score_changes(truth(), good_service(), {}, {change_}, oracle, always)).missed());
}

TEST(TrueChanges, AreWhatStays) {
  using enum satcs::reference::LifeKind;
  const auto changes = true_changes({{safe_mode, 5, 9, 1, 0},
                                     {failed_cell, 7, 7, 1, 1},
                                     {capacity_fade, 3, 6, 0.1, 0},
                                     {efficiency_drift, 3, 8, 0.1, 0},
                                     {redundant_charger, 20, 30, 1, 1},
                                     {redundant_amplifier, 40, 50, 1, 0}});
  ASSERT_EQ(changes.size(), 6U);
  EXPECT_EQ(changes[0].kind, "capacity_fade+efficiency_drift");
  EXPECT_EQ(changes[0].end, 8);
  EXPECT_FALSE(changes[0].is_step());
  EXPECT_EQ(changes[1].kind, "failed_cell");
  EXPECT_TRUE(changes[1].is_step());
  EXPECT_EQ(changes[2].begin, 20);
  EXPECT_EQ(changes[3].begin, 30);
  EXPECT_EQ(changes[4].begin, 40);
  EXPECT_TRUE(changes[4].is_step()) << "a mode of the other family too";
  EXPECT_EQ(changes[5].begin, 50);
}

}  // namespace
}  // namespace reident::trust::score_test
