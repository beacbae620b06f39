#include "service/model/diagnostics_json.hpp"

#include <limits>

#include <gmock/gmock.h>

#include "tests/service/model/example_model.hpp"

namespace reident::test::diagnostics_json_test {
namespace {

using identification::Diagnostics;
using identification::Vector;
using nlohmann::ordered_json;

constexpr double infinity = std::numeric_limits<double>::infinity();

Diagnostics example_diagnostics() {
  Diagnostics diagnostics;
  diagnostics.rows = 500;
  diagnostics.predicted = true;
  diagnostics.whiteness = {{{25, -0.3, 4, 0.09, 0.13, 0.2}, {48, 37.6}}};
  diagnostics.prediction_inputs = {{0, 0, {51, 0.02, -3, 0.09, 0.14, 0}},
                                   {1, 0, {51, 0.5, 7, 0.1, 0.2, 1}}};
  diagnostics.free_run_inputs = {{0, 0, {51, 0.1, 1, 0.2, 0.3, 0}},
                                 {1, 0, {51, 0.1, 1, 0.2, 0.3, 0}}};
  const identification::Score score{Vector::Constant(1, 6.5), Vector::Constant(1, -infinity), 500};
  diagnostics.predictions = {{1, score}, {5, score}};
  diagnostics.free_run = score;
  diagnostics.interval = {Vector::Constant(1, 6.0), Vector::Constant(1, 7.0), 6, 7, 20, 1000, true};
  diagnostics.spread = {10, Vector::Constant(1, 5.0), Vector::Constant(1, 6.25),
                        Vector::Constant(1, infinity)};
  return diagnostics;
}

TEST(DiagnosticsJson, NamesInputsAndOutputsBesideTheirFigures) {
  const ordered_json json = to_json(example_diagnostics(), {"I_1", "I_2"}, {"V"});
  EXPECT_EQ(json["rows"], 500);
  EXPECT_EQ(json["residuals"], "prediction");
  const ordered_json& whiteness = json["whiteness"][0];
  EXPECT_EQ(whiteness["output"], "V");
  EXPECT_EQ(whiteness["white"], false);
  EXPECT_EQ(whiteness["largest"], -0.3);
  EXPECT_EQ(whiteness["lags"], 25);
  EXPECT_EQ(whiteness["lag"], 4);
  EXPECT_EQ(whiteness["ljung_box"], 48);
  const ordered_json& pairs = json["input_correlation"]["prediction"];
  EXPECT_EQ(pairs[0]["input"], "I_1");
  EXPECT_EQ(pairs[0]["significant"], false);
  EXPECT_EQ(pairs[1]["input"], "I_2");
  EXPECT_EQ(pairs[1]["output"], "V");
  EXPECT_EQ(pairs[1]["lag"], 7);
  EXPECT_EQ(pairs[1]["significant"], true);
  EXPECT_EQ(json["input_correlation"]["free_run"].size(), 2u);
  EXPECT_EQ(json["prediction"][1]["steps"], 5);
  EXPECT_EQ(json["prediction"][1]["mrse_percent"][0], 6.5);
  EXPECT_EQ(json["mrse_interval_percent"]["high"][0], 7);
  EXPECT_EQ(json["mrse_interval_percent"]["too_few_rows"], true);
  EXPECT_EQ(json["mrse_of_parts_percent"]["median"][0], 6.25);
}

TEST(DiagnosticsJson, WritesNullForWhatIsNotThereOrNotFinite) {
  Diagnostics diagnostics = example_diagnostics();
  diagnostics.predicted = false;
  diagnostics.prediction_inputs.clear();
  diagnostics.predictions.clear();
  diagnostics.interval.reset();
  diagnostics.whiteness[0].correlation.largest = std::numeric_limits<double>::quiet_NaN();
  const ordered_json json = ordered_json::parse(to_json(diagnostics, {"I_1", "I_2"}, {"V"}).dump());
  EXPECT_EQ(json["residuals"], "free_run");
  EXPECT_TRUE(json["mrse_interval_percent"].is_null());
  EXPECT_TRUE(json["prediction"].empty());
  EXPECT_TRUE(json["free_run"]["fit_percent"][0].is_null());
  EXPECT_TRUE(json["mrse_of_parts_percent"]["largest"][0].is_null());
  EXPECT_TRUE(json["whiteness"][0]["largest"].is_null());
}

TEST(ContinuousJson, HasTheMatricesOrTheReason) {
  identification::StateSpaceModel model = example_model().dynamics;
  const ordered_json matrices = to_json(to_continuous(model));
  EXPECT_EQ(matrices["A"].size(), 2u);
  EXPECT_EQ(matrices["B"][0].size(), 2u);
  model.A << -0.5, 0, 0, 0.7;
  const ordered_json refusal = to_json(to_continuous(model));
  EXPECT_EQ(refusal["rejected"], "no_continuous_time");
  EXPECT_THAT(refusal["reason"].get<std::string>(), testing::HasSubstr("-0.5"));
}

}  // namespace
}  // namespace reident::test::diagnostics_json_test
