#include "service/satcs/platform/handwritten_platform.hpp"

#include <cmath>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "service/satcs/family.hpp"
#include "service/satcs/parameter_id.hpp"
#include "service/satcs/platform/platform_spacecraft.hpp"

namespace reident::satcs::platform::handwritten_platform_test {
namespace {

constexpr storage::Time start = 1'498'867'200'000'000'000;
constexpr int orbit_s = 6016;

TEST(HandwrittenPlatform, SendsItsPointsWhenTheSpacecraftDoes) {
  PlatformSpacecraft spacecraft({}, {}, start, 1);
  HandwrittenPlatform simulator({}, {}, start, 1);
  std::set<std::uint32_t> known, sent;
  for (const auto& d : handwritten_descriptors("S")) {
    EXPECT_EQ(d.id, parameter_id(d.name));
    known.insert(d.id);
  }
  EXPECT_LT(known.size(), telemetry_points().size());
  std::vector<storage::Sample> of_spacecraft, of_simulator;
  for (int k = 0; k < 64; ++k, simulator.advance(), spacecraft.advance()) {
    ASSERT_EQ(simulator.time(), spacecraft.time());
    spacecraft.read(of_spacecraft);
    simulator.read(of_simulator);
    std::set<std::uint32_t> due, read;
    for (const auto& sample : of_spacecraft)
      if (known.contains(sample.parameter)) due.insert(sample.parameter);
    for (const auto& sample : of_simulator) read.insert(sample.parameter);
    EXPECT_EQ(read, due);
    sent.merge(read);
  }
  EXPECT_EQ(sent, known);
}

TEST(HandwrittenPlatform, HasTheDriveLevelsOfTheSpacecraft) {
  PlatformSpacecraft spacecraft({}, {}, start, 3);
  HandwrittenPlatform simulator({}, {}, start, 3);
  double planned = 0;  // for the second before, whose steps the spacecraft has done
  int on = 0;
  for (int k = 0; k < 2 * orbit_s; ++k, simulator.advance(), spacecraft.advance()) {
    if (k > 0) {
      EXPECT_EQ(spacecraft.plant().transmitter().drive_mW(), planned);
    }
    planned = simulator.state().drive_mW;
    on += planned > 0;
  }
  EXPECT_GT(on, 0);
}

TEST(HandwrittenPlatform, IsOfTheSizeOfTheSpacecraftButNotLikeIt) {
  PlatformSpacecraft spacecraft({}, {}, start, 1);
  HandwrittenPlatform simulator({}, {}, start, 1);
  struct Sums {
    double error = 0, size = 0;
  };
  std::map<std::string, Sums> sums;
  for (int k = 0; k < 4 * orbit_s; ++k, simulator.advance(), spacecraft.advance()) {
    const auto add = [&sums](const std::string& name, double model, double real) {
      sums[name].error += std::pow(model - real, 2);
      sums[name].size += real * real;
    };
    const PlatformPlant& plant = spacecraft.plant();
    add("W_RW1", simulator.state().speed_rad_s[0], plant.wheel(0).speed_rad_s());
    add("P_PA", simulator.state().output_W, plant.transmitter().output_W());
    add("T_TANK", simulator.state().heated_C[3], plant.thermal().temperature_C(tank));
    add("T_PZEN", simulator.state().panel_C[zenith_panel],
        plant.thermal().temperature_C(zenith_panel));
  }
  for (const auto& [name, sum] : sums) {
    const double relative = std::sqrt(sum.error / sum.size);
    EXPECT_GT(relative, 0.02) << name;
    EXPECT_LT(relative, 0.9) << name;
  }
}

TEST(HandwrittenPlatform, RestsInSafeMode) {
  const std::vector<reference::LifeEvent> safe{
      reference::usual(reference::LifeKind::safe_mode, start, start)};
  HandwrittenPlatform simulator({}, safe, start, 1);
  EXPECT_TRUE(simulator.state().safe_mode);
  for (int k = 0; k < orbit_s; ++k, simulator.advance()) EXPECT_EQ(simulator.state().drive_mW, 0);
}

}  // namespace
}  // namespace reident::satcs::platform::handwritten_platform_test
