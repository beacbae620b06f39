// Inputs that move together: the rows show what they do together, and a model with gains of -42 and
// 43 is told of where the truth is 0.4 and 0.4.
#include <cmath>
#include <cstdlib>
#include <string>
#include <variant>

#include <gmock/gmock.h>

#include "identification/fit/output_error_fit.hpp"
#include "identification/search/identify.hpp"
#include "identification/statistics/correlation.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::inseparable_inputs_test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

/// A level that changes in one row of 20.
Matrix steps(test::Noise& noise, Index rows) {
  Matrix u(rows, 1);
  double level = 0;
  for (double& value : u.reshaped())
    value = level = noise.uniform() < 0.05 ? noise.normal() : level;
  return u;
}

/// First-order noise of deviation 1.
Matrix coloured(test::Noise& noise, Index rows, double coefficient) {
  Matrix e(rows, 1);
  double last = noise.normal();
  for (double& value : e.reshaped())
    value = last = coefficient * last + std::sqrt(1 - coefficient * coefficient) * noise.normal();
  return e;
}

/// One state for each input, with the gain 0.4 from each input to each output.
StateSpaceModel truth(Index inputs, Index outputs) {
  return {0.9 * Matrix::Identity(inputs, inputs),
          0.04 * Matrix::Identity(inputs, inputs),
          Matrix::Ones(outputs, inputs),
          Matrix::Zero(outputs, inputs),
          {},
          Vector::Zero(inputs),
          Vector::Zero(outputs),
          1};
}

Record recorded(const Matrix& u, Index outputs, test::Noise& noise, double error) {
  const Matrix y = test::simulated(truth(u.cols(), outputs), u, Vector::Zero(u.cols()));
  return contiguous_record(1, u, y + error * noise.normal(y.rows(), outputs));
}

std::vector<std::string> told(const Record& record) {
  const IdentifyResult result = identify(record, record.all(), {});
  std::vector<std::string> sentences;
  if (const auto* found = std::get_if<Identified>(&result))
    for (const std::string& warning : found->warnings)
      if (warning.find("move together") != std::string::npos) sentences.push_back(warning);
  return sentences;
}

TEST(InseparableInputs, NearlyEqualOnesAreToldWithWhatIsKnown) {
  for (std::uint64_t seed = 1; seed <= 15; ++seed) {
    test::Noise noise(seed);
    const Index rows = 600;
    Matrix u(rows, 3);
    u << steps(noise, rows), coloured(noise, rows, 0.8), Matrix(rows, 1);
    u.col(2) = u.col(0) + 0.001 * noise.normal(rows, 1);
    EXPECT_THAT(told(recorded(u, 1, noise, 0.01)),
                ::testing::ElementsAre(AllOf(HasSubstr("input 1 and input 3 move together"),
                                             ContainsRegex("their sum of 0\\.(8|79)"))))
        << seed;
  }
}

TEST(InseparableInputs, OnesThatAddUpAreToldTogetherAndPairsApart) {
  test::Noise noise(40);
  const Index rows = 800;
  Matrix u(rows, 3);
  u.leftCols(2) << coloured(noise, rows, 0.9), steps(noise, rows);
  u.col(2) = u.col(0) + u.col(1) + 0.001 * noise.normal(rows, 1);
  const Matrix sum = u;
  EXPECT_THAT(told(recorded(sum, 1, noise, 0.02)),
              ::testing::ElementsAre(HasSubstr("input 1, input 2 and input 3 move together")));
  u.resize(rows, 4);
  u << sum.leftCols(2), sum.leftCols(2) + 0.001 * noise.normal(rows, 2);
  EXPECT_THAT(told(recorded(u, 1, noise, 0.02)),
              ::testing::ElementsAre(HasSubstr("input 1 and input 3 move together"),
                                     HasSubstr("input 2 and input 4 move together")));
  u = sum.leftCols(1).replicate(1, 4) + 0.001 * noise.normal(rows, 4);
  EXPECT_THAT(told(recorded(u, 1, noise, 0.02)),
              ::testing::ElementsAre(HasSubstr("input 1, input 2, input 3 and input 4 move")));
}

TEST(InseparableInputs, NoneAreToldOfWhereTheRowsShowEachGain) {
  const char* asked = std::getenv("REIDENT_RECORDS");
  const std::uint64_t records = asked ? std::strtoull(asked, nullptr, 10) : 12;
  std::uint64_t found = 0;
  for (std::uint64_t seed = 1; seed <= records; ++seed) {
    test::Noise noise(seed);
    const Index rows = 600;
    Matrix u(rows, 3);
    u << steps(noise, rows), coloured(noise, rows, 0.98), coloured(noise, rows, 0.95);
    if (seed % 2 == 0) u.col(2) = (u.col(1) + 0.1 * u.col(2)).eval();  // correlated by 0.995
    found += !told(recorded(u, 1 + static_cast<Index>(seed % 3 == 0), noise, 0.02)).empty();
  }
  EXPECT_LE(found, records / 100);
  RecordProperty("found", std::to_string(found));
}

/// Of estimates whose errors last or not, where the inputs differ by what lasts or not.
TEST(InseparableInputs, TheUncertaintyOfGainsIsThatOfTheirEstimates) {
  for (const double of_difference : {0.0, 0.9})
    for (const double of_errors : {0.0, 0.9}) {
      int covered = 0;
      constexpr int records = 100;
      for (std::uint64_t seed = 1; seed <= records; ++seed) {
        test::Noise noise(seed);
        const Index rows = 600;
        Matrix u(rows, 2);
        u << steps(noise, rows), Matrix(rows, 1);
        u.col(1) = u.col(0) + 0.01 * coloured(noise, rows, of_difference);
        Record record = recorded(u, 1, noise, 0);
        record.y += 0.01 * coloured(noise, rows, of_errors);
        const Matrix A = Matrix::Constant(1, 1, 0.9), C = Matrix::Ones(1, 1);
        const StateSpaceModel fit =
            fit_response(A, C, true, record, record.all(), Accuracy::exact).model;
        const double gain = fit.C(0) * fit.B(0) / (1 - fit.A(0)) + fit.D(0);
        Series moves(gain_errors_by_row(A, C, true, record, record.all())[0].col(0),
                     {record.all()});
        covered += std::abs(gain - 0.4) <
                   2 * std::sqrt(moves.centred().squaredNorm() * correlated_rows(moves));
      }
      EXPECT_GE(covered, 80) << of_difference << " " << of_errors;
      EXPECT_LE(covered, 99) << of_difference << " " << of_errors;
    }
}

}  // namespace
}  // namespace reident::identification::inseparable_inputs_test
