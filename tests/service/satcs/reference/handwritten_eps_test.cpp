#include "service/satcs/reference/handwritten_eps.hpp"

#include <cmath>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "service/satcs/parameter_id.hpp"
#include "service/satcs/reference/reference_spacecraft.hpp"

namespace reident::satcs::handwritten_eps_test {
namespace {

constexpr storage::Time start = 1'498'867'200'000'000'000;
constexpr int orbit_s = 6016;

std::map<std::string, double> named(const std::vector<storage::ParameterDescriptor>& descriptors,
                                    const std::vector<storage::Sample>& samples) {
  std::map<std::uint32_t, std::string> names;
  for (const auto& d : descriptors) names[d.id] = d.name;
  std::map<std::string, double> values;
  for (const auto& sample : samples) values[names.at(sample.parameter)] = sample.value;
  return values;
}

TEST(HandwrittenEps, BalancesItsCurrentsAndPowers) {
  HandwrittenEps eps({}, {}, start, 1);
  for (int k = 0; k < orbit_s; ++k, eps.advance()) {
    const auto& f = eps.flows();
    EXPECT_NEAR(f.sg2_A + f.bdr_out_A, f.load_A, 1e-12);
    EXPECT_NEAR(f.charge_A - f.bdr_in_A, f.battery_A, 1e-12);
    EXPECT_GE(f.shunt_A, 0);
    EXPECT_LE(f.charge_A, f.section_A);
    EXPECT_EQ(f.bus_V, 28);
    EXPECT_NEAR(f.platform_A + f.transmitter_A + f.heaters_A + f.converter_A[0] + f.converter_A[1] +
                    f.converter_A[2],
                f.load_A, 1e-12);
    EXPECT_GE(eps.charge(), 0);
    EXPECT_LE(eps.charge(), 1);
  }
}

TEST(HandwrittenEps, ClosesItsPowerBudgetOverADay) {
  HandwrittenEps eps({}, {}, start, 1);
  double least = 1;
  for (int k = 0; k < 86400; ++k, eps.advance()) least = std::min(least, eps.charge());
  EXPECT_GT(least, 0.6);
  EXPECT_GT(eps.charge(), 0.6);
}

TEST(HandwrittenEps, HasTheOrbitAndThePlanOfTheSpacecraft) {
  reference::Spacecraft spacecraft({}, {}, start, 3);
  HandwrittenEps eps({}, {}, start, 3);
  int with_payload = 0;
  double planned = 0;  // of the second before, which the spacecraft's loads are in still
  for (int k = 0; k < 4 * orbit_s; ++k, eps.advance(), spacecraft.advance()) {
    ASSERT_EQ(eps.time(), spacecraft.time());
    std::vector<storage::Sample> samples;
    eps.read(samples);
    const auto values = named(handwritten_descriptors("S"), samples);
    const double illumination = spacecraft.plant().orbit().illumination(eps.time());
    EXPECT_EQ(values.at("I_SAG1A") > 0, illumination > 0);
    if (k > 0) {
      EXPECT_EQ(planned > 0, spacecraft.plant().loads().on().payload);
    }
    planned = values.at("S_PAYLOAD");
    with_payload += planned > 0;
  }
  EXPECT_GT(with_payload, 0);
}

TEST(HandwrittenEps, NamesItsPointsAsTheSpacecraftAndHasNoAmplifier) {
  const auto of_spacecraft = reference::telemetry_descriptors("S");
  const auto descriptors = handwritten_descriptors("S");
  for (const auto& d : descriptors) {
    EXPECT_EQ(d.id, parameter_id(d.name));
    EXPECT_EQ(d.spacecraft, "S");
    EXPECT_NE(d.name, "V_MEA");
  }
  EXPECT_LT(descriptors.size(), of_spacecraft.size());
}

TEST(HandwrittenEps, SendsItsPointsWhenTheSpacecraftDoes) {
  reference::Spacecraft spacecraft({}, {}, start, 1);
  HandwrittenEps eps({}, {}, start, 1);
  std::set<std::uint32_t> known, sent;
  for (const auto& d : handwritten_descriptors("S")) known.insert(d.id);
  std::vector<storage::Sample> of_spacecraft, of_eps;
  for (int k = 0; k < 64; ++k, eps.advance(), spacecraft.advance()) {
    spacecraft.read(of_spacecraft);
    eps.read(of_eps);
    std::set<std::uint32_t> due, read;
    for (const auto& sample : of_spacecraft)
      if (known.contains(sample.parameter)) due.insert(sample.parameter);
    for (const auto& sample : of_eps) read.insert(sample.parameter);
    EXPECT_EQ(read, due);
    sent.merge(read);
  }
  EXPECT_EQ(sent, known);
}

TEST(HandwrittenEps, TurnsItsLoadsOffInSafeMode) {
  constexpr storage::Time hour = 3'600'000'000'000;
  const std::vector<reference::LifeEvent> safe_hour = {
      reference::usual(reference::LifeKind::safe_mode, start, start + hour)};
  HandwrittenEps eps({}, safe_hour, start, 1);
  EXPECT_TRUE(eps.flows().on.safe_mode);
  EXPECT_EQ(eps.flows().line_A[reference::camera_line], 0);
  const double safe_A = eps.flows().load_A;
  for (int k = 0; k < 3600; ++k) eps.advance();
  EXPECT_FALSE(eps.flows().on.safe_mode);
  EXPECT_GT(eps.flows().line_A[reference::camera_line], 0);
  EXPECT_GT(eps.flows().load_A, safe_A + 5);
}

TEST(HandwrittenEps, IsOfTheSizeOfTheSpacecraftButNotLikeIt) {
  reference::Spacecraft spacecraft({}, {}, start, 1);
  HandwrittenEps eps({}, {}, start, 1);
  double error = 0, size = 0, battery_error = 0, battery_size = 0;
  for (int k = 0; k < 2 * orbit_s; ++k, eps.advance(), spacecraft.advance()) {
    const auto& real = spacecraft.plant().flows();
    error += std::pow(eps.flows().bdr_out_A - real.bdr_out_A, 2);
    size += std::pow(real.bdr_out_A, 2);
    battery_error += std::pow(eps.flows().battery_V - real.battery_V[0], 2);
    battery_size += std::pow(real.battery_V[0], 2);
  }
  const double bdr = std::sqrt(error / size), battery = std::sqrt(battery_error / battery_size);
  EXPECT_GT(bdr, 0.02);
  EXPECT_LT(bdr, 0.5);
  EXPECT_GT(battery, 0.005);
  EXPECT_LT(battery, 0.2);
}

}  // namespace
}  // namespace reident::satcs::handwritten_eps_test
