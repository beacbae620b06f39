// What reident identify prints of kinds of models.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::identify_kinds_test {
namespace {

using Strings = std::vector<std::string>;
using nlohmann::json;
using ::testing::HasSubstr;

using IdentifyKinds = test::CliTest;

/// A file of rows that begin with an input in random steps; `rest_of` makes the rest of a row of
/// the input and a normal number.
std::string stepped(const std::string& header, int rows,
                    const std::function<std::string(int, double, double)>& rest_of) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  std::string text = header + "\n";
  double u = 0;
  for (int row = 0; row < rows; ++row) {
    if (row % 13 == 0) u = normal(random);
    text += fmt::format("{},{}\n", u, rest_of(row, u, normal(random)));
  }
  return text;
}

TEST_F(IdentifyKinds, GivesEachValueOfAColumnARegime) {
  double x = 0;
  write("switching.csv", stepped("u,mode,y", 900, [&x](int row, double u, double noise) {
          const bool is_in = row % 200 < 80;
          const std::string rest = fmt::format("{},{}", is_in ? 3 : 1, x + 0.01 * noise);
          x = 0.8 * x + 0.2 * (is_in ? 2 : 1) * u;
          return rest;
        }));
  const Strings words = {"identify", "switching.csv", "--input", "u", "--output", "y"};
  Strings with = words;
  with.insert(with.end(), {"--regime", "mode"});
  const json printed = json_of(with);
  EXPECT_EQ(printed["inputs"], json({"u", "in mode == 3", "u in mode == 3"}));
  EXPECT_EQ(printed["regimes"]["used"], true);
  EXPECT_EQ(printed["regimes"]["conditions"], json({"mode == 3"}));
  EXPECT_NEAR(printed["static_gain"][0][2], 1, 0.05);
  EXPECT_GT(printed["fit_percent"]["validate"][0], 95);
  EXPECT_LT(json_of(words)["fit_percent"]["validate"][0], 90);
}

TEST_F(IdentifyKinds, AnIntegratorHasNoGainAtRest) {
  double x = 0;
  write("charge.csv", stepped("u,y", 600, [&x](int, double u, double noise) {
          const double charge = std::exchange(x, x + u);
          return fmt::format("{}", charge + 0.05 * noise);
        }));
  const json printed = json_of({"identify", "charge.csv", "--input", "u", "--output", "y"});
  EXPECT_EQ(printed["order"], 1);
  EXPECT_TRUE(printed["static_gain"].is_null());
}

// A disturbance of the orbit's period, say.
TEST_F(IdentifyKinds, AnOscillationThatDoesNotEndLeavesTheGainsAtRest) {
  double x = 0;
  write("orbit.csv", stepped("u,y", 900, [&x](int row, double u, double noise) {
          const double y = x + 0.5 * std::sin(row / 15.0) + 0.01 * noise;
          x = 0.9 * x + 0.1 * u;
          return fmt::format("{}", y);
        }));
  const json printed = json_of({"identify", "orbit.csv", "--input", "u", "--output", "y"});
  ASSERT_GE(printed["order"], 3);
  EXPECT_NEAR(printed["static_gain"][0][0], 1, 0.05);
}

TEST_F(IdentifyKinds, AnOutputThatIsHeldForSomeRowsIsNamed) {
  for (const int held : {1, 4}) {
    double x = 0, sent = 0;
    write("held.csv", stepped("u,y", 900, [&](int row, double u, double noise) {
            if (row % held == 0) sent = x + 0.01 * noise;
            x = 0.9 * x + 0.1 * u;
            return fmt::format("{:.4f}", sent);
          }));
    Strings words = {"identify", "held.csv", "--input", "u", "--output", "y"};
    for (const bool with_hold : {false, true}) {
      if (with_hold) words.insert(words.end(), {"--hold", "3s"});
      const json printed = json_of(words);
      EXPECT_EQ(printed["warnings"].dump().find("y stands for 4 rows") != std::string::npos,
                held == 4)
          << printed["warnings"];
      EXPECT_EQ(printed["warnings"].dump().find("--time") != std::string::npos, held == 4)
          << "without times all rows are taken, whatever their period";
    }
  }
}

TEST_F(IdentifyKinds, RowsThatNothingExplainsAreLeftOut) {
  double x = 0;
  write("odd.csv", stepped("u,y", 900, [&](int row, double u, double noise) {
          const double y = x + 0.01 * noise + (row % 31 == 7 ? 3 + row % 11 : 0);
          x = 0.9 * x + 0.1 * u;
          return fmt::format("{:.5f}", y);
        }));
  Strings words = {"identify", "odd.csv", "--input", "u", "--output", "y"};
  const json printed = json_of(words);
  std::set<int> rows;
  for (const json& one : printed["left_out"])
    for (const json& range : one["rows"])
      for (int row = range[0]; row < range[1]; ++row) rows.insert(row);
  std::set<int> there;
  for (int row = 7; row < 900; row += 31) there.insert(row);
  EXPECT_EQ(rows, there);
  EXPECT_EQ(printed["left_out"].back()["fault"], "outlier");
  EXPECT_EQ(printed["order"], 1);
  EXPECT_NEAR(printed["static_gain"][0][0], 1, 0.02);
  words.emplace_back("--no-screening");
  EXPECT_EQ(json_of(words)["left_out"], json::array());
}

// More of them than screens take for spikes, and alike, as pulses of equipment are.
TEST_F(IdentifyKinds, SpikesOfAnInputAreLeftOutWhereTheOutputDoesNotFollowThem) {
  for (const bool follows : {false, true}) {
    double x = 0;
    std::mt19937_64 random(6);
    int spikes = 0;
    write("spikes.csv", stepped("true,u,y,still", 900, [&](int, double u, double noise) {
            const bool is_spike = random() % 31 == 0;
            spikes += is_spike ? 1 : 0;
            const double shown = u + (is_spike ? 4 : 0);
            const double y = x + 0.01 * noise;
            x = 0.9 * x + 0.2 * (follows ? shown : u);
            return fmt::format("{:.5f},{:.5f},0.1", shown, y);
          }));
    for (const Strings& more :
         {Strings{}, {"still"}, {"--identify", "300:900", "--validate", "0:300"}}) {
      Strings words = {"identify", "spikes.csv", "--input", "u", "--output", "y"};
      words.insert(words.end(), more.begin(), more.end());
      const json printed = json_of(words);
      EXPECT_EQ(printed["order"], 1);
      EXPECT_NEAR(printed["static_gain"][0][0], 2, 0.02);
      int rows = 0;
      for (const json& one : printed["left_out"]) {
        EXPECT_EQ(one["column"], "u");
        EXPECT_EQ(one["fault"], "unfollowed");
        for (const json& range : one["rows"]) rows += range[1].get<int>() - range[0].get<int>();
      }
      // A row of a step with a spike beside it may look like one too.
      EXPECT_GE(rows, follows ? 0 : spikes);
      EXPECT_LE(rows, follows ? 0 : spikes + 5);
    }
  }
}

TEST_F(IdentifyKinds, WhereRecordsMeetRowsAreLeftOut) {
  double x = 0;
  write("joined.csv", stepped("u,y", 900, [&x](int row, double u, double noise) {
          if (row % 300 == 0) x = 8 - row / 100.0;
          const double y = x + 0.01 * noise;
          x = 0.3 * x + 0.7 * u;
          return fmt::format("{:.5f}", y);
        }));
  const json printed = json_of({"identify", "joined.csv", "--input", "u", "--output", "y"});
  ASSERT_EQ(printed["left_out"].size(), 1u);
  EXPECT_EQ(printed["left_out"][0]["fault"], "outlier");
  EXPECT_EQ(printed["order"], 1);
  EXPECT_NEAR(printed["static_gain"][0][0], 1, 0.01);
}

TEST_F(IdentifyKinds, APlantOfAHigherOrderFollowsItsPulses) {
  double x[3] = {};
  std::mt19937_64 random(7);
  write("slow.csv", stepped("steps,u,y", 900, [&](int, double u, double noise) {
          const double shown = u + (random() % 31 == 0 ? 6 : 0);
          const std::string row = fmt::format("{:.5f},{:.5f}", shown, x[2] + 0.01 * noise);
          x[2] = 0.8 * x[2] + 0.2 * x[1];
          x[1] = 0.8 * x[1] + 0.2 * x[0];
          x[0] = 0.8 * x[0] + 0.2 * shown;
          return row;
        }));
  const json printed =
      json_of({"identify", "slow.csv", "--input", "u", "--output", "y", "--order", "1"});
  EXPECT_EQ(printed["left_out"], json::array());
}

TEST_F(IdentifyKinds, AnOutputAtALimitIsLeftOutThere) {
  for (const double limit : {1.5, 1.0}) {
    double x = 0;
    write("limited.csv", stepped("u,y", 1500, [&](int, double u, double noise) {
            const double y = std::min(limit, x + 0.01 * noise);
            x = 0.9 * x + 0.2 * u;
            return fmt::format("{:.5f}", y);
          }));
    const json printed = json_of({"identify", "limited.csv", "--input", "u", "--output", "y"});
    ASSERT_EQ(printed["left_out"].size(), 1u) << printed["left_out"];
    EXPECT_EQ(printed["left_out"][0]["fault"], "limit");
    EXPECT_EQ(printed["order"], 1);
    EXPECT_NEAR(printed["static_gain"][0][0], 2, 0.04);
  }
}

TEST_F(IdentifyKinds, AnotherZeroOrGainAndAnInputThatSaturatesAreNamed) {
  const auto warnings_of = [this](double shift, double limit, double gain = 1) {
    double x = 0;
    write("odd.csv", stepped("u,y", 900, [&](int row, double u, double noise) {
            const double y = (row >= 400 ? gain : 1) * x + 0.01 * noise + (row >= 400 ? shift : 0);
            x = 0.9 * x + 0.1 * std::clamp(u, -limit, limit);
            return fmt::format("{:.5f}", y);
          }));
    return json_of({"identify", "odd.csv", "--input", "u", "--output", "y"})["warnings"].dump();
  };
  EXPECT_EQ(warnings_of(0, 99), "[]");
  EXPECT_THAT(warnings_of(0.5, 99),
              ::testing::ContainsRegex("y is higher .* from about row (39|40)"));
  EXPECT_THAT(warnings_of(0, 99, 0.8),
              ::testing::ContainsRegex("y answers .* less from about row (39|40)"));
  EXPECT_THAT(warnings_of(0, 0.4), HasSubstr("y is not linear in u"));
}

TEST_F(IdentifyKinds, ASquareThatNoLinearModelFollowsIsNamed) {
  double x = 0;
  write("heat.csv", stepped("u,y", 900, [&](int, double u, double noise) {
          const double y = x + 0.01 * noise;
          x = 0.9 * x + 0.1 * u * u;
          return fmt::format("{:.5f}", y);
        }));
  const auto ran = reident({"identify", "heat.csv", "--input", "u", "--output", "y"});
  EXPECT_EQ(ran.status, 3);
  EXPECT_THAT(ran.err, ::testing::AllOf(HasSubstr("no_better_than_mean"),
                                        HasSubstr("y is not linear in u: the square")));
}

TEST_F(IdentifyKinds, AGainAtRestComesWithWhatItMayBeOffBy) {
  double x = 0;
  write("slow.csv", stepped("u,y", 3000, [&](int, double u, double noise) {
          const double y = x + 0.05 * noise;
          x += (u - x) / 100;
          return fmt::format("{:.5f}", y);
        }));
  const json printed = json_of({"identify", "slow.csv", "--input", "u", "--output", "y"});
  const double off = printed["static_gain_uncertainty"][0][0];
  EXPECT_LT(off, 0.1);
  EXPECT_NEAR(printed["static_gain"][0][0], 1, 2 * off);
  EXPECT_THAT(reident({"identify", "slow.csv", "--input", "u", "--output", "y"}).out,
              HasSubstr(fmt::format(" +-{:.2g}", off)));
}

}  // namespace
}  // namespace reident::cli::identify_kinds_test
