#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "service/support/sha256.hpp"
#include "tests/service/model/example_model.hpp"
#include "tests/support/every_field.hpp"

namespace reident::test::digest_test {
namespace {

using namespace std::string_literals;

TEST(Digest, IsTheSha256OfTheDocumentedEncoding) {
  EquipmentModel model;
  model.spacecraft = "S"s;
  model.equipment = "EQ"s;
  model.inputs = {{"u", "A", 0, 1}};
  model.outputs = {{"y", "", -2, 0}};
  model.dynamics.A = identification::Matrix::Constant(1, 1, 0.5);
  model.dynamics.B = identification::Matrix::Constant(1, 1, 1);
  model.dynamics.C = identification::Matrix::Constant(1, 1, 2);
  model.dynamics.D = identification::Matrix::Constant(1, 1, 0);
  model.dynamics.u0 = identification::Vector::Constant(1, 1);
  model.dynamics.y0 = identification::Vector::Constant(1, -2);
  model.dynamics.period_s = 1;
  model.sample_hold_ns = 0x0102;

  const std::string zero(8, '\0');
  const std::string half = "\0\0\0\0\0\0\xe0\x3f"s;
  const std::string one = "\0\0\0\0\0\0\xf0\x3f"s;
  const std::string two = "\0\0\0\0\0\0\0\x40"s;
  const std::string minus_two = "\0\0\0\0\0\0\0\xc0"s;
  const std::vector<std::string> input = {"\x01\0\0\0u"s, "\x01\0\0\0A"s, zero, one};
  const std::vector<std::string> output = {"\x01\0\0\0y"s, "\0\0\0\0"s, minus_two, zero};
  const std::vector<std::string> a_b_c_d = {half, one, two, zero};
  std::string encoding = "\x0f\0\0\0reident model 1\x01\0\0\0S\x02\0\0\0EQ"s;
  const auto append = [&](const std::vector<std::string>& parts) {
    for (const std::string& part : parts) encoding.append(part);
  };
  append({"\x01\0\0\0"s});
  append(input);
  append({"\x01\0\0\0"s});
  append(output);
  append({one, "\x02\x01\0\0\0\0\0\0"s, "\x01\0\0\0"s});  // period, sample hold, order
  append(a_b_c_d);
  append({"\0\0\0\0"s, one, minus_two});  // no K, offsets
  EXPECT_EQ(model_digest(model), sha256_hex(encoding));
}

void expect_different_digests(const EquipmentModel& base,
                              const std::vector<std::function<void(EquipmentModel&)>>& changes) {
  std::set<std::string> digests;
  for (const auto& change : changes) {
    EquipmentModel model = base;
    change(model);
    digests.insert(model_digest(model));
  }
  EXPECT_EQ(digests.size(), changes.size());
}

TEST(Digest, ChangesWithEverythingThatASimulatorComputesWith) {
  const std::vector<std::function<void(EquipmentModel&)>> changes = {
      [](EquipmentModel&) {},
      [](EquipmentModel& m) { m.spacecraft = "CBERS4A"s; },
      [](EquipmentModel& m) { m.equipment = "BDR2"s; },
      [](EquipmentModel& m) { m.inputs[0].name += "x"; },
      [](EquipmentModel& m) { m.inputs[0].unit = "mA"s; },
      [](EquipmentModel& m) { m.inputs[1].low = -0.3; },
      [](EquipmentModel& m) { m.inputs[1].high = 4.5; },
      [](EquipmentModel& m) { std::swap(m.inputs[0], m.inputs[1]); },
      [](EquipmentModel& m) { m.outputs[0].unit = "V"s; },
      [](EquipmentModel& m) { m.sample_hold_ns += 1; },
      [](EquipmentModel& m) { m.phase_ns = 1; },
      [](EquipmentModel& m) { m.dynamics.period_s = 2; },
      [](EquipmentModel& m) { m.dynamics.A(0, 1) += 1e-16; },
      [](EquipmentModel& m) { m.dynamics.A.transposeInPlace(); },
      [](EquipmentModel& m) { m.dynamics.B(1, 1) = 0; },
      [](EquipmentModel& m) { m.dynamics.C(0, 0) = -1; },
      [](EquipmentModel& m) { m.dynamics.D(0, 1) = -0.0; },
      [](EquipmentModel& m) { m.dynamics.K(1, 0) = 0; },
      [](EquipmentModel& m) { m.dynamics.K.resize(0, 0); },
      [](EquipmentModel& m) { m.dynamics.u0(1) = 1; },
      [](EquipmentModel& m) { m.dynamics.y0(0) = 1; },
  };
  expect_different_digests(example_model(), changes);
}

TEST(Digest, ChangesWithTheExpressionsAndTheTrackingGain) {
  expect_different_digests(
      full_example_model(),
      {
          [](EquipmentModel&) {},
          [](EquipmentModel& m) { m = example_model(); },
          [](EquipmentModel& m) { m.inputs[1].expression += "*1"; },
          [](EquipmentModel& m) { m.inputs[1].expression.clear(); },
          [](EquipmentModel& m) { std::swap(m.inputs[0].expression, m.inputs[1].expression); },
          [](EquipmentModel& m) { m.tracking.reset(); },
          [](EquipmentModel& m) { m.tracking->gain.state(1, 0) = 0; },
          [](EquipmentModel& m) { m.tracking->gain.state.transposeInPlace(); },
          [](EquipmentModel& m) { m.tracking->gain.integral(0, 1) += 1e-16; },
          [](EquipmentModel& m) { m.tracking->gain.error_limit(0) = 2; },
      });
}

TEST(Digest, CoversEveryFieldThatSaysSoAndNoOther) {
  const EquipmentModel model = distinct_version().model;
  for_each_change(
      model, [&](const std::string& path, const Field& field, const EquipmentModel& changed) {
        EXPECT_EQ(model_digest(changed) != model_digest(model), field.digest == Digest::digested)
            << path;
      });
}

TEST(Digest, OfAModelWithoutExpressionsAndTrackingIsTheOneItHadBeforeThereWereAny) {
  EXPECT_EQ(model_digest(example_model()),
            "17910f60ef1713b1804a8bb1ac83963863c0cef758d0f6d27535e0d025323a45");
}

TEST(Digest, OfAModelWithExpressionsAndTrackingIsTheOneItAlwaysHad) {
  EXPECT_EQ(model_digest(full_example_model()),
            "10128ba884ce968e9f617aaa343c60dba711522cf1a4c03e8b2ea8091a2b3960");
}

TEST(Digest, EndsWithWhatNotEveryModelHas) {
  const auto number = [](double value) {
    return std::string(reinterpret_cast<const char*>(&value), sizeof value);
  };
  EquipmentModel model;
  model.inputs = {{"u"s, "A"s, 0, 0, "a+b"s}};
  model.outputs = {{"y"s, "A"s, 0, 0}};
  model.dynamics.A = model.dynamics.B = model.dynamics.C = model.dynamics.D =
      identification::Matrix::Zero(1, 1);
  model.dynamics.u0 = model.dynamics.y0 = identification::Vector::Zero(1);
  const identification::TrackingGain gain{identification::Matrix::Constant(1, 1, 3),
                                          (identification::Matrix(1, 2) << 4, 5).finished(),
                                          identification::Vector::Constant(1, 6)};
  model.tracking = EquipmentModel::Tracking{gain, {}};

  const std::string u = "\x01\0\0\0u\x01\0\0\0A"s + number(0) + number(0);
  const std::string y = "\x01\0\0\0y\x01\0\0\0A"s + number(0) + number(0);
  const std::string one = "\x01\0\0\0"s;
  std::string encoding = "\x0f\0\0\0reident model 1\0\0\0\0\0\0\0\0"s + one + u + one + y;
  encoding += number(0) + std::string(8, '\0') + one;  // period, sample hold, order
  encoding += std::string(4 * 8, '\0') + "\0\0\0\0"s + std::string(2 * 8, '\0');
  encoding += "\x0b\0\0\0expressions\x03\0\0\0a+b\x08\0\0\0tracking"s;
  encoding += number(3) + number(4) + number(5) + number(6);
  EXPECT_EQ(model_digest(model), sha256_hex(encoding));
}

TEST(Digest, DoesNotDependOnWhenAndHowTheModelWasFound) {
  EquipmentModel model = example_model();
  model.method = "other"s;
  model.identified_from = {0, 1};
  model.validated_on = {1, 2};
  model.validation.mrse_percent(0) = 99;
  EXPECT_EQ(model_digest(model), model_digest(example_model()));
}

}  // namespace
}  // namespace reident::test::digest_test
