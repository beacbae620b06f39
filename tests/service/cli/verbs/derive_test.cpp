// `reident identify --derive`: inputs that follow from columns.
#include <cmath>

#include <fmt/format.h>

#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::derive_test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Strings = std::vector<std::string>;

/// A converter: its output current follows the input power over the bus voltage.
std::string converter_csv(int rows, int off_begin = 0, int off_end = 0) {
  std::string text = "u_in,i_in,v_bus,i_out\n";
  double state = 0;
  for (int k = 0; k < rows; ++k) {
    const double u = 15 + 4 * std::sin(0.05 * k), i = 1 + 0.8 * std::sin(0.13 * k + 1);
    const bool off = k >= off_begin && k < off_end;
    const double v = off ? 0 : 8 + 0.5 * std::cos(0.031 * k);
    text += fmt::format("{},{},{},{}\n", u, i, v, state + 0.001 * (k % 7));
    if (!off) state = 0.6 * state + 0.4 * 0.9 * u * i / v;
  }
  return text;
}

class Derive : public test::CliTest {
 protected:
  Strings command(const Strings& more) const {
    Strings words = {"identify", "converter.csv", "--output", "i_out"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(Derive, IdentifiesFromWhatTheExpressionGives) {
  write("converter.csv", converter_csv(900));
  const json apart = json_of(command({"--input", "u_in", "i_in", "v_bus"}));
  const json derived = json_of(command({"--derive", "P = u_in * i_in / v_bus", "--input", "P"}));
  EXPECT_THAT(derived["inputs"], ElementsAre("P"));
  EXPECT_THAT(derived["derived"],
              ElementsAre(json{{"name", "P"}, {"expression", "u_in * i_in / v_bus"}}));
  EXPECT_THAT(apart["derived"], IsEmpty());
  EXPECT_LT(derived["mrse_percent"]["validate"][0], 0.3);
  EXPECT_GT(apart["mrse_percent"]["validate"][0], 1);
}

TEST_F(Derive, GivesTheBitsOfAColumnWithTheSameNumbers) {
  std::string text = "a,b,p,y\n";
  double state = 0;
  for (int k = 0; k < 600; ++k) {
    const double a = std::round(100 * std::sin(0.3 * k)) / 64, b = k % 11;
    text += fmt::format("{},{},{},{}\n", a, b, a * b + a, state);
    state = 0.7 * state + 0.3 * (a * b + a) + 0.01 * (k % 5);
  }
  write("converter.csv", text);
  const Strings output = {"identify", "converter.csv", "--output", "y", "--input"};
  const auto with = [&output](Strings more) {
    more.insert(more.begin(), output.begin(), output.end());
    return more;
  };
  const json column = json_of(with({"p"}));
  const json derived = json_of(with({"q", "--derive", "q=a*b+a"}));
  for (const char* key : {"A", "B", "C", "D", "x0", "mrse_percent"})
    EXPECT_EQ(derived[key], column[key]) << key;
}

TEST_F(Derive, SplitsTheRowsWhereThereIsNoFiniteValue) {
  write("converter.csv", converter_csv(900, 200, 220));
  const json printed = json_of(command({"--derive", "P=u_in*i_in/v_bus", "--input", "P", "i_in"}));
  EXPECT_THAT(printed["warnings"],
              Contains("at 20 of 900 rows a derived input has no finite value; they were left out "
                       "and the record is split there"));
}

TEST_F(Derive, TakesTwoInputsAndAComparison) {
  write("converter.csv", converter_csv(600));
  const json printed = json_of(command({"--derive", "P=u_in*i_in", "--derive",
                                        "on = i_in >= 0.5 ? 1 : 0", "--input", "P,on,v_bus"}));
  EXPECT_THAT(printed["inputs"], ElementsAre("P", "on", "v_bus"));
}

TEST_F(Derive, RefusesWhatCannotBeWithTheRemedy) {
  write("converter.csv", converter_csv(60));
  const std::vector<std::pair<Strings, const char*>> cases = {
      {{"--derive", "P", "--input", "P"}, "--derive P is no input; write it as NAME=EXPRESSION"},
      {{"--derive", "=u_in", "--input", "u_in"}, "write it as NAME=EXPRESSION"},
      {{"--derive", "P=u_in*", "--input", "P"}, "--derive P: expression at byte 6: a number"},
      {{"--derive", "P=u_in", "--input", "i_in"}, "--derive P: name P is not used"},
      {{"--derive", "P=i_out*2", "--input", "P"}, "uses the output i_out"},
      {{"--derive", "v_bus=u_in", "--input", "v_bus"}, "the file has a column v_bus"},
      {{"--derive", "P=u_on*2", "--input", "P"}, "--derive P: "},
      {{"--derive", "P=u_in", "--derive", "Q=P*2", "--input", "P", "Q"}, "derived itself"}};
  for (const auto& [more, says] : cases) EXPECT_THAT(refusal_of(command(more)), HasSubstr(says));
}

}  // namespace
}  // namespace reident::cli::derive_test
