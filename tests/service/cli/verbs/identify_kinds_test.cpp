// What reident identify prints of kinds of models.
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::identify_kinds_test {
namespace {

using Strings = std::vector<std::string>;
using nlohmann::json;

using IdentifyKinds = test::CliTest;

TEST_F(IdentifyKinds, GivesEachValueOfAColumnARegime) {
  std::string text = "u,mode,y\n";
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double u = 0, x = 0;
  for (int row = 0; row < 900; ++row) {
    if (row % 13 == 0) u = normal(random);
    const bool is_in = row % 200 < 80;
    text += fmt::format("{},{},{}\n", u, is_in ? 3 : 1, x + 0.01 * normal(random));
    x = 0.8 * x + 0.2 * (is_in ? 2 : 1) * u;
  }
  write("switching.csv", text);
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

TEST_F(IdentifyKinds, AnIntegratorHasNoGainAtRestInTextOrJson) {
  std::string text = "u,y\n";
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double u = 0, x = 0;
  for (int row = 0; row < 600; ++row) {
    if (row % 13 == 0) u = normal(random);
    text += fmt::format("{},{}\n", u, x + 0.05 * normal(random));
    x += u;
  }
  write("charge.csv", text);
  const json printed = json_of({"identify", "charge.csv", "--input", "u", "--output", "y"});
  EXPECT_EQ(printed["order"], 1);
  EXPECT_TRUE(printed["static_gain"].is_null());
}

}  // namespace
}  // namespace reident::cli::identify_kinds_test
