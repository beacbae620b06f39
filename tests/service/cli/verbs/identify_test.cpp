#include <cmath>
#include <iterator>
#include <random>
#include <sstream>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::identify_test {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;
using Strings = std::vector<std::string>;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using nlohmann::json;

/// Inputs and outputs of a second-order system with two inputs, two outputs, an operating point and
/// some noise. In the last rows the inputs rest.
struct Plant {
  MatrixXd u, y;
};

Plant plant(Eigen::Index rows, Eigen::Index last_rows = 0) {
  std::mt19937 random(20170717);
  std::normal_distribution<double> normal;
  const Eigen::Matrix2d A{{0.9, 0.2}, {-0.1, 0.8}}, B{{1, 0.3}, {0, 0.5}}, C{{1, 0}, {0.4, 1}};
  Plant result{MatrixXd(rows, 2), MatrixXd(rows, 2)};
  Eigen::Vector2d x(3, -1), u(0, 0);
  for (Eigen::Index row = 0; row < rows; ++row) {
    for (double& value : u) value = row < rows - last_rows ? 0.7 * value + normal(random) : 0;
    const Eigen::Vector2d noise(0.05 * normal(random), 0.05 * normal(random));
    result.u.row(row) = u.transpose().array() + 5;
    result.y.row(row) = (C * x + noise).transpose().array() + 28;
    x = A * x + B * u;
  }
  return result;
}

std::string csv_of(
    const Plant& plant, const std::string& first_column = "row",
    const std::function<std::string(Eigen::Index)>& first_cell = [](Eigen::Index row) {
      return std::to_string(row);
    }) {
  std::string text = first_column + ",u1,u2,y1,y2,mode\n";
  for (Eigen::Index row = 0; row < plant.u.rows(); ++row)
    text += fmt::format("{},{},{},{},{},SUN\n", first_cell(row), plant.u(row, 0), plant.u(row, 1),
                        plant.y(row, 0), plant.y(row, 1));
  return text;
}

MatrixXd matrix(const json& rows) {
  MatrixXd result(rows.size(), rows.empty() ? 0 : rows[0].size());
  for (Eigen::Index r = 0; r < result.rows(); ++r)
    for (Eigen::Index c = 0; c < result.cols(); ++c)
      result(r, c) = rows[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
  return result;
}

VectorXd vector(const json& values) {
  VectorXd result(values.size());
  for (Eigen::Index i = 0; i < result.size(); ++i) result(i) = values[static_cast<std::size_t>(i)];
  return result;
}

/// Rows from `begin` on, simulated by what the program printed and nothing else.
MatrixXd simulated(const json& printed, const MatrixXd& u, Eigen::Index begin, Eigen::Index end) {
  const MatrixXd A = matrix(printed["A"]), B = matrix(printed["B"]), C = matrix(printed["C"]),
                 D = matrix(printed["D"]);
  const VectorXd u0 = vector(printed["input_offset"]), y0 = vector(printed["output_offset"]);
  VectorXd x = vector(printed["x0"]);
  MatrixXd y_hat(end - begin, C.rows());
  for (Eigen::Index row = begin; row < end; ++row) {
    const VectorXd du = u.row(row).transpose() - u0;
    y_hat.row(row - begin) = (C * x + D * du + y0).transpose();
    x = A * x + B * du;
  }
  return y_hat;
}

/// The errors by their definition.
void expect_errors(const json& printed, const std::string& part, const MatrixXd& y,
                   const MatrixXd& y_hat) {
  for (Eigen::Index q = 0; q < y.cols(); ++q) {
    const double error = (y.col(q) - y_hat.col(q)).norm();
    const auto at = static_cast<std::size_t>(q);
    const double mrse = 100 * error / y.col(q).norm();
    const double fit = 100 * (1 - error / (y.col(q).array() - y.col(q).mean()).matrix().norm());
    EXPECT_NEAR(printed["mrse_percent"][part][at], mrse, 1e-9 * std::max(1.0, mrse)) << part;
    EXPECT_NEAR(printed["fit_percent"][part][at], fit, 1e-9 * std::max(1.0, std::abs(fit))) << part;
  }
}

class Identify : public test::CliTest {
 protected:
  Strings command(Strings more = {}) const {
    Strings words = {"identify", "plant.csv", "--input", "u1", "u2", "--output", "y1", "y2"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(Identify, PrintsMatricesThatGiveTheSameErrorsToAnyone) {
  const Plant data = plant(900);
  write("plant.csv", csv_of(data));
  const json printed =
      json_of(command({"--identify", "100:500", "--validate", "600:900", "--period", "0.5"}));
  const MatrixXd y_hat = simulated(printed, data.u, 100, 900);
  expect_errors(printed, "identify", data.y.middleRows(100, 400), y_hat.topRows(400));
  expect_errors(printed, "validate", data.y.middleRows(600, 300), y_hat.bottomRows(300));
  EXPECT_LT(printed["mrse_percent"]["validate"][0], 1);
  EXPECT_GT(printed["fit_percent"]["validate"][0], 90);
  EXPECT_EQ(printed["sample_period_s"], 0.5);
  EXPECT_EQ(printed["stable"], true);
  EXPECT_LT(printed["spectral_radius"], 1);
  EXPECT_THAT(printed["warnings"], IsEmpty());
}

TEST_F(Identify, PrintsEveryKeyOfTheContract) {
  write("plant.csv", csv_of(plant(600)));
  const json printed = json_of(command({"--order", "3", "--horizon", "8"}));
  EXPECT_EQ(printed["order"], 3);
  EXPECT_EQ(printed["horizon"], 8);
  for (const char* key : {"order",
                          "horizon",
                          "weighting",
                          "sample_period_s",
                          "A",
                          "B",
                          "C",
                          "D",
                          "K",
                          "x0",
                          "input_offset",
                          "output_offset",
                          "stable",
                          "spectral_radius",
                          "mrse_percent",
                          "fit_percent",
                          "diagnostics",
                          "continuous",
                          "search_work",
                          "timing_ms",
                          "warnings"})
    EXPECT_TRUE(printed.contains(key)) << key;
  EXPECT_THAT(printed["A"], SizeIs(3));
  EXPECT_THAT(printed["A"], Each(SizeIs(3)));
  EXPECT_THAT(printed["B"], Each(SizeIs(2)));
  EXPECT_THAT(printed["C"], SizeIs(2));
  EXPECT_THAT(printed["D"], Each(SizeIs(2)));
  EXPECT_THAT(printed["x0"], SizeIs(3));
  EXPECT_EQ(printed["sample_period_s"], 1);
  EXPECT_GE(printed["timing_ms"].size(), 3u);
}

TEST_F(Identify, UsesTwoThirdsToIdentifyAndTheRestToValidate) {
  write("plant.csv", csv_of(plant(600)));
  json given = json_of(command({"--identify", "0:400", "--validate", "400:600"}));
  json by_default = json_of(command());
  given.erase("timing_ms");
  by_default.erase("timing_ms");
  EXPECT_EQ(by_default, given);
}

TEST_F(Identify, PrintsTheSameWithAnyNumberOfThreads) {
  write("plant.csv", csv_of(plant(900)));
  json one = json_of(command({"--threads", "1"}));
  json four = json_of(command({"--threads", "4"}));
  EXPECT_GT(one["search_work"], 0);
  one.erase("timing_ms");
  four.erase("timing_ms");
  EXPECT_EQ(four, one);
}

TEST_F(Identify, TakesNamesInCommasAndInRepeatedFlags) {
  write("plant.csv", csv_of(plant(600)));
  json words = json_of(command());
  json commas =
      json_of({"identify", "plant.csv", "--input", "u1,u2", "--output", "y1", "--output", "y2"});
  words.erase("timing_ms");
  commas.erase("timing_ms");
  EXPECT_EQ(commas, words);
}

/// Its gain is 2 in mode 3 and 1 in mode 1, which is there more often.
TEST_F(Identify, WarnsWhenTheRangesOverlap) {
  write("plant.csv", csv_of(plant(600)));
  const json printed = json_of(command({"--identify", "0:400", "--validate", "300:600"}));
  EXPECT_THAT(printed["warnings"], Contains(HasSubstr("not an error on unseen data")));
}

TEST_F(Identify, ValidatesOnEarlierRowsFromAnEstimatedState) {
  write("plant.csv", csv_of(plant(600)));
  const json printed = json_of(command({"--identify", "200:600", "--validate", "0:200"}));
  EXPECT_THAT(printed["warnings"], Contains(HasSubstr("least-squares estimate")));
  EXPECT_GT(printed["fit_percent"]["validate"][0], 90);
}

TEST_F(Identify, LeavesRowsWithMissingCellsOutAndSaysHowMany) {
  Plant data = plant(900);
  data.u(450, 0) = std::nan("");
  data.y(700, 1) = std::nan("");
  write("plant.csv", csv_of(data));
  const json printed = json_of(command());
  EXPECT_THAT(printed["warnings"], Contains(StartsWith("2 of 900 rows have a missing")));
  EXPECT_THAT(printed["warnings"], Contains(HasSubstr("3 stretches")));
  EXPECT_GT(printed["fit_percent"]["validate"][1], 90);
}

TEST_F(Identify, SaysWhereX0StandsWhenTheFirstRowIsIncomplete) {
  Plant data = plant(900);
  data.u.topRows(2).setConstant(std::nan(""));
  write("plant.csv", csv_of(data));
  const json printed = json_of(command({"--identify", "0:600", "--validate", "600:900"}));
  EXPECT_THAT(printed["warnings"], Contains(HasSubstr("x0 is the state at row 2")));
  const MatrixXd y_hat = simulated(printed, data.u, 2, 900);
  expect_errors(printed, "validate", data.y.bottomRows(300), y_hat.bottomRows(300));
}

TEST_F(Identify, PutsTimedRowsOnAGridThatRangesDoNotMove) {
  const Plant data = plant(900);
  write("plant.csv", csv_of(data));
  json by_rows =
      json_of(command({"--period", "2", "--identify", "0:500", "--validate", "500:900"}));
  const auto seconds = [](Eigen::Index row) { return fmt::format("{}", 1700000000 + 2 * row); };
  write("plant.csv", csv_of(data, "unix_s", seconds));
  json by_time = json_of(command(
      {"--time", "unix_s", "--period", "2", "--identify", "0:500", "--validate", "500:900"}));
  for (const char* differs : {"timing_ms", "found"}) {
    by_rows.erase(differs);
    by_time.erase(differs);
  }
  EXPECT_EQ(by_time, by_rows);
}

TEST_F(Identify, TakesTheMedianStepOfIsoTimesAndSplitsAtGaps) {
  const auto iso = [](Eigen::Index row) {
    const Eigen::Index second = 10 * row + (row >= 300 ? 7200 : 0);
    return fmt::format("2023-04-{:02}T{:02}:{:02}:{:02}Z", 1 + second / 86400, second / 3600 % 24,
                       second / 60 % 60, second % 60);
  };
  write("plant.csv", csv_of(plant(900), "utc", iso));
  const json printed = json_of(command({"--time", "utc"}));
  EXPECT_EQ(printed["sample_period_s"], 10);
  EXPECT_THAT(printed["warnings"], Contains(HasSubstr("a grid of 10s, the usual step of utc")));
  EXPECT_THAT(printed["warnings"], Contains(HasSubstr("2 stretches")));
  EXPECT_GT(printed["fit_percent"]["validate"][0], 80);
}

TEST_F(Identify, PrintsNullForAFitThatIsNotFinite) {
  Plant data = plant(600);
  data.y.bottomRows(200).col(1).setConstant(28);
  write("plant.csv", csv_of(data));
  const json printed = json_of(command({"--no-screening"}));
  EXPECT_TRUE(printed["fit_percent"]["validate"][1].is_null());
  EXPECT_THAT(printed["warnings"], Contains(HasSubstr("it is null")));
}

TEST_F(Identify, NamesTheSensorThatStandsStillInAllValidationRows) {
  Plant data = plant(600);
  data.y.bottomRows(200).col(1).setConstant(28);
  write("plant.csv", csv_of(data));
  const test::Ran ran = reident(command());
  EXPECT_EQ(ran.status, 2);
  EXPECT_THAT(ran.err, HasSubstr("y2 stands still in 200 rows (400 to 599)"));
  EXPECT_THAT(ran.err, HasSubstr("--no-screening"));
}

TEST_F(Identify, SaysWhatIsMissingWhereNothingDrivesTheOutput) {
  write("alone.csv", "time,v\n0,28\n1,28.1\n2,28\n3,28.1\n");
  const test::Ran ran = reident({"identify", "alone.csv", "--time", "time", "--output", "v"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_THAT(ran.err, HasSubstr("Add telemetry of the cause"));
}

TEST_F(Identify, LeavesOutFaultsAndSaysWhichRows) {
  Plant data = plant(600);
  for (const int row : {20, 21, 200, 450}) data.y(row, 0) = -999;
  write("plant.csv", csv_of(data));
  const json printed = json_of(command());
  EXPECT_EQ(
      printed["left_out"],
      json::parse(R"([{"column":"y1","fault":"fill","rows":[[20,22],[200,201],[450,451]]}])"));
  const test::Ran kept = reident(command({"--no-screening", "--json"}));
  EXPECT_EQ(json::parse(kept.out).value("left_out", json()), json::array());
}

TEST_F(Identify, SaysThatValidationRowsInWhichNothingMovesSayNothing) {
  for (const double noise : {0.0, 0.08}) {
    Plant data = plant(900);
    data.u.bottomRows(300).setConstant(5);
    data.y.bottomRows(300) = 28 + noise * Eigen::ArrayXXd::Random(300, 2);
    write("plant.csv", csv_of(data));
    const test::Ran ran = reident(command(
        {"--order", "2", "--no-screening", "--identify", "0:550", "--validate", "650:900"}));
    EXPECT_THAT(ran.out, HasSubstr("say nothing about the fit")) << noise;
    EXPECT_THAT(ran.out, Not(HasSubstr("do not use it"))) << noise;
  }
  write("plant.csv", csv_of(plant(900, 300)));
  const Strings resting = {"--no-screening", "--identify", "0:550", "--validate", "625:900"};
  EXPECT_THAT(reident(command(resting)).out, HasSubstr("say nothing about the fit"));
}

TEST_F(Identify, SaysOfAnOutputThatIsZeroInTheValidationRowsNoErrorThatIsNoNumber) {
  Plant data = plant(900);
  data.u.bottomRows(300).setConstant(5);
  data.y.bottomRows(300).setZero();
  write("plant.csv", csv_of(data));
  const test::Ran ran = reident(
      command({"--order", "2", "--no-screening", "--identify", "0:550", "--validate", "650:900"}));
  EXPECT_THAT(ran.out, HasSubstr("say nothing about the fit"));
  EXPECT_THAT(ran.out, Not(HasSubstr("nan")));
}

TEST_F(Identify, SaysOfAModelThatMissesWhatMovesAnOutputThatItIsBad) {
  Plant data = plant(900);
  for (Eigen::Index row = 0; row < 900; ++row)
    data.y(row, 0) = 28 +
                     (row < 600 ? 10 : 6) * std::sin((0.02 + 4e-5 * static_cast<double>(row)) *
                                                     static_cast<double>(row)) +
                     (row < 600 ? 1.5 * (data.u(row, 0) - 5) : 0);
  write("plant.csv", csv_of(data));
  const test::Ran ran = reident(command({"--order", "2", "--no-screening"}));
  EXPECT_THAT(ran.out, HasSubstr("worse than the mean of y1: do not use it"));
  EXPECT_THAT(ran.out, Not(HasSubstr("say nothing about the fit")));
}

TEST_F(Identify, ReportsInWordsWithoutJson) {
  write("plant.csv", csv_of(plant(600)));
  const test::Ran ran = reident(command({"--order", "2"}));
  EXPECT_EQ(ran.status, 0);
  EXPECT_THAT(ran.out, StartsWith("order 2, horizon"));
  EXPECT_THAT(ran.out, HasSubstr("poles 0.8"));
  EXPECT_THAT(ran.out, HasSubstr("MRSE validate %"));
  EXPECT_THAT(ran.out, HasSubstr("\ny2 "));
  EXPECT_THAT(ran.out, HasSubstr("MRSE % (95 % interval)"));
  EXPECT_THAT(ran.out, HasSubstr("1 ahead"));
  EXPECT_THAT(ran.out, HasSubstr("  y2: "));
  EXPECT_THAT(ran.out, HasSubstr("continuous time: "));
}

TEST_F(Identify, DiagnosesTheModelOnTheValidationRows) {
  write("plant.csv", csv_of(plant(900)));
  const json printed = json_of(command({"--order", "2"}));
  const json& diagnostics = printed["diagnostics"];
  EXPECT_EQ(diagnostics["rows"], 300);
  EXPECT_EQ(diagnostics["free_run"]["mrse_percent"], printed["mrse_percent"]["validate"]);
  EXPECT_EQ(diagnostics["whiteness"][1]["output"], "y2");
  EXPECT_THAT(diagnostics["input_correlation"]["free_run"], SizeIs(4));
  for (const std::size_t q : {0u, 1u}) {
    const double error = printed["mrse_percent"]["validate"][q];
    EXPECT_LT(diagnostics["mrse_interval_percent"]["low"][q], error);
    EXPECT_GT(diagnostics["mrse_interval_percent"]["high"][q], error);
  }
}

TEST_F(Identify, PrintsTheContinuousTimeModelOfTheSamePeriod) {
  write("plant.csv", csv_of(plant(900)));
  const json printed = json_of(command({"--order", "2", "--period", "500ms"}));
  const MatrixXd A = matrix(printed["continuous"]["A"]);
  // The determinant of exp(A T) is exp(trace(A) T).
  EXPECT_NEAR(std::exp(0.5 * A.trace()), matrix(printed["A"]).determinant(), 1e-9);
  EXPECT_EQ(matrix(printed["continuous"]["B"]).cols(), 2);
}

TEST_F(Identify, TakesDAsItIsTold) {
  write("plant.csv", csv_of(plant(600)));
  EXPECT_EQ(matrix(json_of(command({"--no-direct"}))["D"]).norm(), 0);
  EXPECT_GT(matrix(json_of(command({"--direct"}))["D"]).norm(), 0);
}

TEST_F(Identify, GivesTheReasonWhenTheDataGiveNoModel) {
  Plant data = plant(600);
  data.y.setConstant(28);
  write("plant.csv", csv_of(data));
  const test::Ran ran = reident(command({"--json"}));
  EXPECT_EQ(ran.status, 3);
  const json printed = json::parse(ran.out);
  EXPECT_EQ(printed["rejected"], "constant_outputs");
  EXPECT_THAT(printed["reason"].get<std::string>(), Not(IsEmpty()));
  const test::Ran words = reident(command());
  EXPECT_EQ(words.status, 3);
  EXPECT_THAT(words.err, StartsWith("reident: no model (constant_outputs): "));
}

TEST_F(Identify, RejectsAFileOfFewRows) {
  write("plant.csv", csv_of(plant(6)));
  const test::Ran ran = reident(command({"--json"}));
  EXPECT_EQ(ran.status, 3);
  EXPECT_EQ(json::parse(ran.out)["rejected"], "too_few_samples");
}

struct Impossible {
  const char* name;
  std::string command;  // words after identify, separated by blanks
  std::string expected;
};
std::ostream& operator<<(std::ostream& out, const Impossible& request) {
  return out << request.name;
}

class ImpossibleRequests : public test::CliTest,
                           public ::testing::WithParamInterface<Impossible> {};

TEST_P(ImpossibleRequests, ExitTwoWithOneLineThatSaysWhatWouldMendThem) {
  write("plant.csv", csv_of(plant(100)));
  write("header.csv", "u1,y1\n");
  write("empty.csv", "");
  write("one.csv", "u1,y1\n1,2\n");
  write("back.csv", "t,u1,y1\n1,1,1\n3,2,2\n2,3,3\n");
  write("still.csv", "t,u1,y1\n1,1,1\n1,2,2\n");
  write("holes.csv", "u1,y1\n1,1\n2,2\n3,\n4,\n");
  std::istringstream command("identify " + GetParam().command);
  const Strings words{std::istream_iterator<std::string>(command), {}};
  EXPECT_THAT(refusal_of(words), HasSubstr(GetParam().expected));
}

const Impossible requests[] = {
    {"no_file", "none.csv --input u1 --output y1", "none.csv"},
    {"a_folder", ". --input u1 --output y1", "is a directory"},
    {"no_regular_file", "/dev/null --input u1 --output y1", "save it to a file"},
    {"no_input", "plant.csv --output y1", "name columns that do, of row, u1, u2, y2, mode"},
    {"no_output", "plant.csv --input u1", "--output is required"},
    {"file_after_the_names", "--input u1 --output y1 plant.csv --json",
     "name the CSV file before the flags"},
    {"unknown_flag", "plant.csv --input u1 --output y1 --ordr 2", "--ordr"},
    {"unknown_input", "plant.csv --input u9 --output y1", "u1, u2, y1, y2"},
    {"unknown_output", "plant.csv --input u1 --output y9", "--output"},
    {"unknown_time", "plant.csv --input u1 --output y1 --time t", "--time"},
    {"input_twice", "plant.csv --input u1 u1 --output y1", "names u1 twice"},
    {"output_is_input", "plant.csv --input u1 --output u1", "named already"},
    {"time_is_input", "plant.csv --input row --output y1 --time row", "leave it out"},
    {"column_of_words", "plant.csv --input mode --output y1", "mode holds no number"},
    {"regime_of_many_values", "plant.csv --input u1 --output y1 --regime u2", "more than 8 values"},
    {"regime_of_no_column", "plant.csv --input u1 --output y1 --regime u9>1", "u1, u2, y1, y2"},
    {"regime_of_an_output", "plant.csv --input u1 --output y1 --regime y1>1", "uses the output y1"},
    {"regime_of_no_expression", "plant.csv --input u1 --output y1 --regime u2>", "a number"},
    {"range_without_colon", "plant.csv --input u1 --output y1 --identify 50", "write it as A:B"},
    {"range_of_words", "plant.csv --input u1 --output y1 --identify a:b", "write it as A:B"},
    {"negative_range", "plant.csv --input u1 --output y1 --identify=-5:50", "write it as A:B"},
    {"reversed_range", "plant.csv --input u1 --output y1 --identify 50:10",
     "holds no row; the file has rows 0 to 99"},
    {"range_beyond_the_file", "plant.csv --input u1 --output y1 --validate 50:101",
     "ends after the last row; the file has rows 0 to 99"},
    {"nothing_left_to_validate", "plant.csv --input u1 --output y1 --identify 0:100",
     "give --validate"},
    {"nothing_left_to_identify", "plant.csv --input u1 --output y1 --validate 0:100",
     "give --identify"},
    {"order_below_zero", "plant.csv --input u1 --output y1 --order -1", "--order -1"},
    {"order_of_words", "plant.csv --input u1 --output y1 --order many",
     "neither auto nor a whole number"},
    {"short_horizon", "plant.csv --input u1 --output y1 --order 5 --horizon 3",
     "make it at least 6"},
    {"short_horizon_of_outputs_in_commas",
     "plant.csv --input u1 --output y1,y2 --order 7 --horizon 4", "make it at least 5"},
    {"direct_and_not", "plant.csv --input u1 --output y1 --direct --no-direct", "excludes"},
    {"delay_without_samples", "plant.csv --input u1 --output y1 --delay u1", "INPUT=SAMPLES"},
    {"delay_of_words", "plant.csv --input u1 --output y1 --delay u1=some", "INPUT=SAMPLES"},
    {"delay_too_long", "plant.csv --input u1 --output y1 --delay u1=1001", "0 to 1000"},
    {"delay_of_an_output", "plant.csv --input u1 u2 --output y1 --delay y1=2",
     "names y1, which is no input; inputs: u1, u2"},
    {"delay_twice", "plant.csv --input u1 --output y1 --delay u1=1 u1=2", "names u1 twice"},
    {"delay_and_largest_delay", "plant.csv --input u1 --output y1 --delay u1=1 --max-delay 5",
     "excludes"},
    {"largest_delay_of_words", "plant.csv --input u1 --output y1 --max-delay far",
     "no whole number of rows from 0 to 1000"},
    {"negative_period", "plant.csv --input u1 --output y1 --period -1", "--period -1"},
    {"period_is_nan", "plant.csv --input u1 --output y1 --period nan", "--period nan"},
    {"period_too_short_for_the_times", "plant.csv --input u1 --output y1 --time row --period 0.1",
     "make it at least 333333334ns"},
    {"no_thread", "plant.csv --input u1 --output y1 --threads 0",
     "--threads 0 is no whole number from 1 to 256"},
    {"too_many_threads", "plant.csv --input u1 --output y1 --threads 257", "--threads 257"},
    {"threads_of_words", "plant.csv --input u1 --output y1 --threads all", "--threads all"},
    {"no_rows", "header.csv --input u1 --output y1", "no row of data"},
    {"empty_file", "empty.csv --input u1 --output y1", "empty.csv"},
    {"one_row", "one.csv --input u1 --output y1", "1 row"},
    {"time_goes_back", "back.csv --input u1 --output y1 --time t --clock-back stop",
     "back.csv:4: the clock goes back"},
    {"time_stands_still", "still.csv --input u1 --output y1 --time t",
     "is the time of the row before"},
    {"time_of_words", "plant.csv --input u1 --output y1 --time mode", "plant.csv:2"},
    {"no_row_to_validate_on", "holes.csv --input u1 --output y1", "none with every column valid"},
};

INSTANTIATE_TEST_SUITE_P(Table, ImpossibleRequests, ::testing::ValuesIn(requests),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace reident::cli::identify_test
