#include "service/cli/output/diagnostics_text.hpp"

#include <gmock/gmock.h>

#include "service/cli/output/model_text.hpp"

namespace reident::cli::diagnostics_text_test {
namespace {

using identification::Diagnostics;
using identification::Vector;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::string> inputs = {"u1", "u2"}, outputs = {"y1"};

Diagnostics good() {
  Diagnostics diagnostics;
  diagnostics.rows = 500;
  diagnostics.predicted = true;
  diagnostics.whiteness = {{{25, 0.08, 4, 0.09, 0.13, 0}, {20, 37.6}}};
  diagnostics.prediction_inputs = {{0, 0, {51, 0.02, -3, 0.09, 0.14, 0}},
                                   {1, 0, {51, 0.1, 7, 0.1, 0.2, 1}}};
  const auto score = [](double mrse) {
    return identification::Score{Vector::Constant(1, mrse), Vector::Constant(1, 90), 500};
  };
  diagnostics.predictions = {{1, score(2.5)}, {10, score(6.25)}};
  diagnostics.free_run = score(10.534);
  diagnostics.interval = {Vector::Constant(1, 9.8), Vector::Constant(1, 11.3), 9.8, 11.3, 20, 1000};
  diagnostics.spread = {10, Vector::Constant(1, 5.0), Vector::Constant(1, 9.0),
                        Vector::Constant(1, 14.0)};
  return diagnostics;
}

std::string text(const Diagnostics& diagnostics) {
  return diagnostics_text(diagnostics, inputs, outputs);
}

TEST(DiagnosticsText, GivesTheErrorWithItsIntervalAndItsGrowth) {
  EXPECT_EQ(text(good()),
            "how sure the error on the validation rows (500) is:\n"
            "output  MRSE % (95 % interval)  in 10 parts: best  median  worst\n"
            "y1      10.53 (9.8 to 11.3)                     5       9     14\n"
            "MRSE % when K corrects the state by the outputs up to so many rows before:\n"
            "output  1 ahead  10 ahead  free run\n"
            "y1          2.5      6.25     10.53\n"
            "what the prediction of the next row leaves:\n"
            "  y1: white, nothing left but chance; no input would explain more of it linearly\n");
}

TEST(DiagnosticsText, SaysHowFarFromWhiteTheResidualsAre) {
  Diagnostics diagnostics = good();
  diagnostics.whiteness = {{{25, 0.62, 1, 0.09, 0.13, 0.8}, {600, 37.6}}};
  EXPECT_THAT(text(diagnostics),
              HasSubstr("y1: not white (r = 0.62 with itself 1 row before; chance: 0.09)"));
  diagnostics.whiteness = {{{25, -0.05, 3, 0.01, 0.02, 0.4}, {60, 37.6}}};
  EXPECT_THAT(text(diagnostics),
              HasSubstr("y1: nearly white (r = -0.05 with itself 3 rows before; chance: 0.01)"));
}

TEST(DiagnosticsText, NamesTheInputsThatWouldExplainMore) {
  Diagnostics diagnostics = good();
  diagnostics.prediction_inputs[0].correlation = {51, 0.4, 0, 0.09, 0.14, 0.2};
  diagnostics.prediction_inputs[1].correlation = {51, -0.3, 7, 0.09, 0.14, 0.2};
  EXPECT_THAT(text(diagnostics), HasSubstr("; u1 of the same row would explain 16 % of it; "
                                           "u2 of 7 rows before would explain 9 % of it\n"));
  diagnostics.prediction_inputs[0].correlation = {51, 0.4, -1, 0.09, 0.14, 0.2};
  EXPECT_THAT(text(diagnostics), HasSubstr("; u1 follows it by 1 row: feedback;"));
  diagnostics.prediction_inputs[0].correlation = {51, 0.05, 2, 0.01, 0.02, 0.9};  // of many rows
  EXPECT_THAT(text(diagnostics), Not(HasSubstr("u1 of 2")));
}

TEST(DiagnosticsText, SaysWhatIsMissing) {
  Diagnostics diagnostics = good();
  diagnostics.interval->too_few_rows = true;
  EXPECT_THAT(text(diagnostics), HasSubstr("the interval is too narrow\n"));
  diagnostics.interval.reset();
  diagnostics.predicted = false;
  diagnostics.predictions.clear();
  diagnostics.prediction_inputs.clear();
  diagnostics.free_run_inputs = {{1, 0, {51, 0.3, 7, 0.09, 0.14, 0.2}}};
  EXPECT_THAT(text(diagnostics), HasSubstr("what the free run leaves (the model has no K):"));
  EXPECT_THAT(text(diagnostics), HasSubstr("u2 of 7 rows before"));
  EXPECT_THAT(text(diagnostics), Not(HasSubstr("ahead")));
}

TEST(DiagnosticsText, OfFewRowsSaysSo) {
  Diagnostics diagnostics = good();
  diagnostics.interval.reset();
  diagnostics.spread.parts = 1;
  diagnostics.whiteness = {{}};
  diagnostics.prediction_inputs = {{0, 0, {}}, {1, 0, {}}};
  EXPECT_THAT(text(diagnostics), HasSubstr("output  MRSE % (95 % interval)\ny1      10.53\n"));
  EXPECT_THAT(text(diagnostics), HasSubstr("  y1: too few rows to tell\n"));
}

TEST(ContinuousText, HasThePolesOrTheReason) {
  identification::ContinuousModel model;
  model.A.resize(3, 3);
  model.A << -5, 0, 0, 0, -0.5, 2, 0, -2, -0.5;
  EXPECT_EQ(continuous_text(model), "continuous time: poles -0.5 ± 2j, -5 1/s\n");
  EXPECT_EQ(continuous_text(identification::Verdict{identification::VerdictCode::no_continuous_time,
                                                    "the pole is odd"}),
            "continuous time: none; the pole is odd\n");
}

}  // namespace
}  // namespace reident::cli::diagnostics_text_test
