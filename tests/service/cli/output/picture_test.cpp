// Axes, traces and SVG of `reident plot`.
#include <cmath>

#include <gmock/gmock.h>

#include "service/cli/output/axis.hpp"
#include "service/cli/output/model_picture.hpp"
#include "service/cli/output/svg.hpp"
#include "service/cli/output/trace.hpp"

namespace reident::cli::picture_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t hour = 3600 * second;
constexpr std::int64_t start = 1'700'000'000 * second;  // 2023-11-14T22:13:20Z

std::vector<std::string> labels(const std::vector<Tick>& ticks) {
  std::vector<std::string> result;
  for (const Tick& tick : ticks) result.push_back(tick.label);
  return result;
}

TEST(Ticks, AreRoundAndNotTooMany) {
  EXPECT_THAT(labels(ticks_of({0, 10, 0, 1}, 6)), ElementsAre("0", "2", "4", "6", "8", "10"));
  EXPECT_THAT(labels(ticks_of({-0.03, 0.06, 0, 1}, 5)),
              ElementsAre("-0.02", "0.00", "0.02", "0.04", "0.06"));
  for (const double width : {1e-9, 0.003, 0.7, 1.0, 31.0, 8e5, 3e12}) {
    const auto ticks = ticks_of({5, 5 + width, 0, 1}, 6);
    EXPECT_GE(ticks.size(), 2U) << width;
    EXPECT_LE(ticks.size(), 7U) << width;
  }
}

TEST(Scale, AroundOneValueHasRoom) {
  const Scale scale = scale_around(28, 28, 100, 0);
  EXPECT_LT(scale.low, 28);
  EXPECT_NEAR(scale(28), 50, 1e-9);
  EXPECT_TRUE(std::isfinite(scale_around(0, 0, 0, 1)(0)));
}

TEST(TimeTicks, AreRoundTimesOfUtcWithTheDayWhereItChanges) {
  EXPECT_THAT(labels(time_ticks({start, start + 4 * hour}, 8)),
              ElementsAre("2023-11-14 22:30", "23:00", "23:30", "2023-11-15 00:00", "00:30",
                          "01:00", "01:30", "02:00"));
  const auto ticks = time_ticks({start, start + 20 * second}, 8);
  EXPECT_EQ(ticks[0].label, "2023-11-14 22:13:20");
  EXPECT_EQ(ticks[1].value, 5);
  EXPECT_THAT(labels(time_ticks({start, start + 100 * 24 * hour}, 8)), Not(SizeIs(0)));
}

TEST(Trace, KeepsTheExtremesOfEachColumnInTheirOrder) {
  // Two columns of ten values; a peak, then a trough in the first.
  TraceSegment segment;
  for (int k = 0; k < 20; ++k) {
    segment.x.push_back(k / 10.0);
    segment.y.push_back(k == 3 ? 9 : k == 7 ? -9 : 0);
  }
  const auto lines = trace({segment}, {0, 2, 0, 2}, {-10, 10, 20, 0}, 1);
  ASSERT_THAT(lines, SizeIs(1));
  std::vector<double> y;
  for (const Point& point : lines[0]) y.push_back(point.y);
  EXPECT_THAT(y, ElementsAre(1, 19, 10));
}

TEST(Trace, BreaksAtGapsThatCanBeSeenAndShowsALonelyValue) {
  const std::vector<TraceSegment> segments = {{{0, 1}, {0, 0}}, {{1.5}, {0}}, {{50}, {0}}};
  const auto lines = trace(segments, {0, 100, 0, 100}, {-1, 1, 1, 0}, 1);
  ASSERT_THAT(lines, SizeIs(2));
  EXPECT_THAT(lines[1], SizeIs(2));
}

TEST(Trace, StaysWithinTheScale) {
  const auto lines = trace({{{0, 1}, {-1e9, 1e9}}}, {0, 1, 0, 10}, {-1, 1, 100, 0}, 1);
  EXPECT_EQ(lines[0][0].y, 100);
  EXPECT_EQ(lines[0][1].y, 0);
}

TEST(Svg, EscapesWhatANameMayHold) {
  EXPECT_EQ(xml_escaped("a<b> & \"c\"'\n"), "a&lt;b&gt; &amp; &quot;c&quot;&#39;");
  Svg svg(10, 10, "<&>", "");
  svg.text({1, 2}, "<x>", "small");
  const std::string text = std::move(svg).finish();
  EXPECT_THAT(text, HasSubstr("<title>&lt;&amp;&gt;</title>"));
  EXPECT_THAT(text, HasSubstr(">&lt;x&gt;</text>"));
}

/// A model of `outputs` outputs that misses each by a slow oscillation, over `rows` rows.
struct Example {
  EquipmentModel model;
  ModelRun run;
  storage::TimeRange range;

  Example(int outputs, Eigen::Index rows) {
    auto& dynamics = model.dynamics;
    dynamics.A = Eigen::Matrix2d{{0.9, 0.2}, {-0.2, 0.9}};
    dynamics.B = Eigen::MatrixXd::Zero(2, 1);
    dynamics.C = Eigen::MatrixXd::Ones(outputs, 2);
    dynamics.D = Eigen::MatrixXd::Zero(outputs, 1);
    dynamics.u0 = Eigen::VectorXd::Zero(1);
    dynamics.y0 = Eigen::VectorXd::Zero(outputs);
    dynamics.period_s = 1;
    model.validation = {Eigen::VectorXd::Constant(outputs, 2.5),
                        Eigen::VectorXd::Constant(outputs, 91.25), 100};
    Eigen::MatrixXd y(rows, outputs);
    for (int q = 0; q < outputs; ++q) {
      model.outputs.push_back({"V<" + std::to_string(q) + ">", "V", 0, 1});
      for (Eigen::Index k = 0; k < rows; ++k) y(k, q) = std::sin(double(k * k % 9973) + q);
    }
    run.data.record =
        identification::contiguous_record(1, Eigen::MatrixXd::Zero(rows, 1), std::move(y));
    run.data.record.segments[0].first_tick = start / second;
    run.y_hat = run.data.record.y * 0.9;
    range = {start, start + rows * second};
  }
  std::string picture() const {
    const storage::Time third = (range.end - range.begin) / 3;
    return model_picture({"SAT/EQ version 3",
                          "approved",
                          model,
                          run,
                          range,
                          {{"identify", {range.begin, range.begin + third}},
                           {"validate", {range.end - third, range.end}}},
                          {100, 10, 1, 0.1, 0}});
  }
};

TEST(Picture, ShowsEachSeriesThePartsTheSingularValuesAndThePoles) {
  const std::string picture = Example(2, 600).picture();
  for (const char* id : {"output-1-real", "output-1-simulated", "output-1-error", "output-2-real",
                         "output-2-simulated", "output-2-error", "singular-values", "poles"})
    EXPECT_THAT(picture, HasSubstr(std::string("<g id=\"") + id + "\">")) << id;
  for (const char* words :
       {"V&lt;0&gt; [V]", "measured", "free run of the model", "UTC", "identify", "validate",
        "2023-11-14 22:14", "MRSE 2.5 %, fit 91.2 %", "order 2", "Hz"})
    EXPECT_THAT(picture, HasSubstr(words));
  EXPECT_THAT(picture, Not(HasSubstr("nan")));
  EXPECT_THAT(picture, Not(HasSubstr("inf")));
}

TEST(Picture, OfAModelThatCanFollowTelemetryShowsThatErrorToo) {
  Example example(1, 600);
  EXPECT_THAT(example.picture(), Not(HasSubstr("output-1-following")));
  example.run.tracked = ModelRun::Tracked{example.run.data.record.y * 0.99, {}};
  example.model.tracking = EquipmentModel::Tracking{{}, example.model.validation};
  EXPECT_THAT(example.picture(), HasSubstr("<g id=\"output-1-following\">"));
  EXPECT_THAT(example.picture(), HasSubstr("following telemetry: MRSE 2.5 %"));
}

TEST(Picture, ShowsInputsWhatWasLeftOutAnotherVersionAndTheChange) {
  Example example(1, 600);
  example.model.inputs.push_back({"I_IN", "A", 0, 1});
  PictureData data{.title = "SAT/EQ version 3",
                   .subtitle = "approved",
                   .model = example.model,
                   .run = example.run,
                   .range = example.range,
                   .parts = {},
                   .singular_values = {}};
  std::string picture = model_picture(data);
  EXPECT_THAT(picture, HasSubstr("<g id=\"input-1\">"));
  EXPECT_THAT(picture, HasSubstr("I_IN [A]"));
  for (const char* absent : {"left out", "output-1-other", "class=\"change\""})
    EXPECT_THAT(picture, Not(HasSubstr(absent)));
  data.parts = {{"excluded", {start, start + 60 * second}},
                {"excluded", {start + 90 * second, start + 95 * second}}};
  data.change = start + 300 * second;
  ModelRun other = example.run;
  other.y_hat *= 1.05;
  other.score = data.run.score;
  data.other = PictureData::Other{"version 2", std::move(other)};
  picture = model_picture(data);
  for (const char* shown : {"left out", "<g id=\"output-1-other\">",
                            "<g id=\"output-1-other-error\">", "version 2", "class=\"change\""})
    EXPECT_THAT(picture, HasSubstr(shown));
  EXPECT_EQ(picture.find("left out"), picture.rfind("left out")) << "the legend names it once";
  data.change = example.range.end;
  EXPECT_THAT(model_picture(data), Not(HasSubstr("class=\"change\"")));
}

TEST(Picture, OfManyRowsAndOutputsStaysSmall) {
  EXPECT_LT(Example(1, 200'000).picture().size(), 100'000U);
  EXPECT_LT(Example(12, 20'000).picture().size(), 500'000U);
}

TEST(Picture, OfARunThatGoesFarAwayStillShowsWhatWasMeasured) {
  Example example(1, 600);
  example.run.y_hat *= 1e12;
  const std::string picture = example.picture();
  EXPECT_THAT(picture, HasSubstr(">-1</text>"));
  EXPECT_THAT(picture, Not(HasSubstr("e+1")));
}

TEST(Picture, OfOutputsThatDoNotMoveAndAStaticModelIsWhole) {
  Example example(1, 600);
  example.run.data.record.y.setConstant(28);
  example.run.y_hat.setConstant(28);
  example.model.dynamics.A.resize(0, 0);
  example.model.dynamics.B.resize(0, 1);
  example.model.dynamics.C.resize(1, 0);
  const std::string picture = example.picture();
  EXPECT_THAT(picture, Not(HasSubstr("nan")));
  EXPECT_THAT(picture, HasSubstr("order 0"));
}

}  // namespace
}  // namespace reident::cli::picture_test
