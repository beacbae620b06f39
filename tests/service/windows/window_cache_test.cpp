#include "service/windows/window_cache.hpp"

#include "service/operations/refresh.hpp"
#include "tests/service/daemon_fixture.hpp"

namespace reident::test::window_cache_test {
namespace {

class WindowCaches : public DaemonTest {
 protected:
  WindowCaches() { archive.describe(descriptors()); }

  /// Whether the kept window and a fresh read of the archive give the same rows.
  void expect_as_read_afresh(storage::TimeRange window) {
    const auto kept_result = kept.load(archive, window);
    const auto fresh_result = load_window(archive, kept.request(), window);
    const auto& a = std::get<WindowData>(kept_result);
    const auto& b = std::get<WindowData>(fresh_result);
    EXPECT_EQ(a.record.u, b.record.u);
    EXPECT_EQ(a.record.y, b.record.y);
    EXPECT_EQ(a.record.segments, b.record.segments);
    EXPECT_EQ(a.coverage, b.coverage);
  }

  storage::Database database = open();
  storage::Archive archive{database};
  WindowCache kept = window_cache_of("SAT", plant());
};

TEST_F(WindowCaches, GiveWhatTheArchiveHoldsWhereverTheyBegin) {
  archive.append(telemetry(day, 1500));
  archive.append(telemetry(day + 1700 * second, 2000));  // behind a gap
  for (const int begin : {0, 100, 511, 512, 600, 1400, 1600, 2100})
    expect_as_read_afresh({day + begin * second, day + (begin + 1500) * second});
}

TEST_F(WindowCaches, ReadAChunkAgainOnceItIsForgotten) {
  archive.append(telemetry(day, 2000));
  const storage::TimeRange window{day, day + 2000 * second};
  kept.load(archive, window);
  archive.append(telemetry(day + 700 * second + second / 2, 30, 2.0));
  kept.forget({day + 700 * second, day + 731 * second});
  const std::int64_t before = kept.ticks_read();
  expect_as_read_afresh(window);
  EXPECT_LE(kept.ticks_read() - before, 4 * 512);
}

TEST_F(WindowCaches, HaveRowsWhereTheQualityIsUsable) {
  storage::Time begin = day;
  for (const storage::Quality quality : storage::qualities) {
    auto frames = telemetry(begin, 60);
    for (auto& frame : frames)
      for (storage::Sample& sample : frame.samples) sample.quality = quality;
    archive.append(frames);
    const auto result = kept.load(archive, {begin, begin + minute});
    EXPECT_EQ(std::get<WindowData>(result).record.rows(), storage::is_usable(quality) ? 60 : 0)
        << storage::name(quality);
    expect_as_read_afresh({begin, begin + minute});
    begin += 10 * minute;
  }
}

TEST_F(WindowCaches, WithoutSamplesHaveNoRows) {
  const auto result = kept.load(archive, {day, day + 10 * minute});
  EXPECT_EQ(std::get<WindowData>(result).record.rows(), 0);
  EXPECT_EQ(std::get<WindowData>(result).coverage, 0);
}

TEST_F(WindowCaches, NameAParameterThatNobodyDescribed) {
  EquipmentConfig equipment = plant();
  equipment.inputs.push_back("w");
  WindowCache unknown = window_cache_of("SAT", equipment);
  const auto result = unknown.load(archive, {day, day + 10 * minute});
  EXPECT_EQ(std::get<UnknownParameter>(result).name, "w");
}

TEST_F(WindowCaches, ComputeDerivedInputsWithTheBitsOfAFreshRead) {
  EquipmentConfig equipment = plant();
  equipment.inputs = {"v", "q"};
  equipment.derived = {{"q", "v / max(u, 0) + 0.1 * u", "V"}};  // not finite while u <= 0
  kept = window_cache_of("SAT", equipment);
  archive.append(telemetry(day, 3000));
  for (const int begin : {0, 600, 1100}) {
    expect_as_read_afresh({day + begin * second, day + (begin + 1500) * second});
    const auto loaded = kept.load(archive, {day + begin * second, day + (begin + 1500) * second});
    const auto& data = std::get<WindowData>(loaded);
    EXPECT_NEAR(data.coverage, 1. / 3, 0.02) << "u is above 0 for 40 s of 120";
    EXPECT_EQ(data.read_coverage, data.coverage) << "all of it is believed";
    EXPECT_GE(data.record.segments.size(), 12U);
    EXPECT_TRUE((data.record.u.col(1).array() == data.record.u.col(0).array() + 0.1).all());
  }
  const auto result = kept.load(archive, {day, day + 10 * minute});
  const WindowData& data = std::get<WindowData>(result);
  EXPECT_EQ(data.inputs[1].unit, "V");
  EXPECT_EQ(data.inputs[1].expression, equipment.derived[0].expression);
  EXPECT_EQ(data.inputs[0].expression, "");
}

TEST_F(WindowCaches, SayWhatABiasOfASensorDoesToDerivedInputs) {
  EquipmentConfig equipment = plant();
  equipment.inputs = {"v", "q"};
  equipment.derived = {{"q", "u * v", "V"}};
  kept = window_cache_of("SAT", equipment);
  archive.append(telemetry(day, 1000));
  const storage::TimeRange window{day, day + 1000 * second};
  const auto result = kept.load(
      archive, window, WantedPart{ticks_of(window, kept.request().period), {{"u"}, {"v", -1}}});
  const WindowData& data = std::get<WindowData>(result);
  ASSERT_EQ(data.bias_effects.size(), 2U);
  for (const identification::Record& effect : data.bias_effects)
    EXPECT_EQ(effect.segments, data.record.segments);
  const auto v = data.record.u.col(0), q = data.record.u.col(1);
  EXPECT_TRUE(data.bias_effects[0].u.col(0).isZero());
  EXPECT_TRUE(data.bias_effects[0].u.col(1).isApprox(v, 1e-9)) << "of u: v";
  EXPECT_EQ(data.bias_effects[1].y, v);
  EXPECT_TRUE(data.bias_effects[1].u.col(0).isApprox(identification::Vector::Ones(v.size())));
  EXPECT_TRUE((data.bias_effects[1].u.col(1).array() * v.array()).isApprox(q.array(), 1e-9))
      << "of v: u";
}

TEST_F(WindowCaches, ABiasOfAnInputItselfIsThatOfItsSensor) {
  archive.append(telemetry(day, 1000));
  const storage::TimeRange window{day, day + 1000 * second};
  const WindowRequest& request = kept.request();
  ASSERT_TRUE(request.derived.empty());
  const auto result = kept.load(
      archive, window, WantedPart{ticks_of(window, request.period), biases_of(request.inputs, {})});
  const WindowData& data = std::get<WindowData>(result);
  ASSERT_EQ(data.bias_effects.size(), request.inputs.size());
  for (std::size_t j = 0; j < request.inputs.size(); ++j) {
    const auto column = static_cast<identification::Index>(j);
    EXPECT_EQ(data.bias_effects[j].y, data.record.u.col(column));
    identification::Matrix unit =
        identification::Matrix::Zero(data.record.rows(), data.record.u.cols());
    unit.col(column).setOnes();
    EXPECT_TRUE(data.bias_effects[j].u.isApprox(unit, 1e-9));
  }
}

/// What the inputs are above those without the bias, at its size; below 0 there is no root, and a
/// sensor does not read too high by twice what it is above, or more.
TEST_F(WindowCaches, SayWhatABiasDoesAtItsSizeAndAtTheEndOfWhatAnInputIsDefinedFor) {
  EquipmentConfig equipment = plant();
  equipment.inputs = {"v", "q"};
  equipment.derived = {{"q", "(u + 1.1) ^ 0.5", "V"}};
  kept = window_cache_of("SAT", equipment);
  archive.append(telemetry(day, 1000));  // u is -1, 0 and 1 in turn
  const storage::TimeRange window{day, day + 1000 * second};
  const std::vector<SensorBias> biases = biases_of(equipment.inputs, equipment.derived);
  const auto result =
      kept.load(archive, window, WantedPart{ticks_of(window, kept.request().period), biases});
  const WindowData& data = std::get<WindowData>(result);
  ASSERT_EQ(data.bias_effects.size(), biases.size());
  const double deviation = std::sqrt(2.0 / 3);
  for (std::size_t i = 0; i < 2 * bias_sizes; ++i)
    for (identification::Index row = 0; row < data.record.rows(); ++row) {
      const double bias = size_of(biases[i], deviation), u = data.bias_effects[i].y(row, 0) + 1.1;
      const bool is_possible = bias < 0.2;  // 0.1 is the least that the root is taken of
      const double without = std::sqrt(std::max(0.0, u - bias));
      const double expected = is_possible ? (std::sqrt(u) - without) / bias : 0;
      EXPECT_NEAR(data.bias_effects[i].u(row, 1), expected, 0.05) << bias << ' ' << u;
    }
}

TEST_F(WindowCaches, NameAParameterOfAnExpressionThatNobodyDescribed) {
  EquipmentConfig equipment = plant();
  equipment.inputs = {"q"};
  equipment.derived = {{"q", "u * w", "V"}};
  WindowCache unknown = window_cache_of("SAT", equipment);
  const auto result = unknown.load(archive, {day, day + 10 * minute});
  EXPECT_EQ(std::get<UnknownParameter>(result).name, "w");
}

TEST_F(WindowCaches, AskForDerivedInputsInTheOrderOfTheInputs) {
  EquipmentConfig equipment = plant();
  equipment.inputs = {"first", "second"};
  equipment.derived = {{"second", "2 * u", "V"}, {"first", "u + 1", "V"}};
  const WindowRequest request = request_of("SAT", equipment);
  EXPECT_EQ(request.derived.at(0).name, "first") << "as models have them";
  EXPECT_EQ(request.derived.at(1).name, "second");
}

}  // namespace
}  // namespace reident::test::window_cache_test
