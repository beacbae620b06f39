#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <gmock/gmock.h>

#include "tests/service/model/example_model.hpp"
#include "tests/support/every_field.hpp"

namespace reident::test::model_json_test {
namespace {

using identification::Matrix;

/// Finite doubles of every magnitude, denormals and both zeros among them.
Matrix any_numbers(identification::Index rows, identification::Index columns, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  Matrix matrix(rows, columns);
  for (double& value : matrix.reshaped()) {
    do {
      value = std::bit_cast<double>(generator());
    } while (!std::isfinite(value));
  }
  return matrix;
}

TEST(ModelJson, GivesTheSameModelBackToTheLastBit) {
  EquipmentModel model = example_model();
  model.dynamics.A = any_numbers(2, 2, 1);
  model.dynamics.B = any_numbers(2, 2, 2);
  model.dynamics.B(0, 0) = -0.0;
  model.dynamics.B(1, 0) = std::numeric_limits<double>::denorm_min();
  model.dynamics.B(0, 1) = std::numeric_limits<double>::max();
  model.dynamics.K = any_numbers(2, 1, 3);
  model.inputs[0].low = 0.1;
  model.sample_hold_ns = std::numeric_limits<std::int64_t>::max();

  const EquipmentModel back = equipment_model_from_json(to_json(model).dump());
  EXPECT_THAT(differing_fields(back, model), testing::IsEmpty());
  EXPECT_EQ(model_digest(back), model_digest(model));
}

TEST(ModelJson, KeepsAStaticModelWithoutGain) {
  EquipmentModel model = example_model();
  model.dynamics.A.resize(0, 0);
  model.dynamics.B.resize(0, 2);
  model.dynamics.C.resize(1, 0);
  model.dynamics.K.resize(0, 0);
  const EquipmentModel back = equipment_model_from_json(to_json(model).dump());
  EXPECT_EQ(back.dynamics.order(), 0);
  EXPECT_EQ(back.dynamics.B.cols(), 2);
  EXPECT_EQ(back.dynamics.C.rows(), 1);
  EXPECT_EQ(back.dynamics.K.size(), 0);
  EXPECT_EQ(model_digest(back), model_digest(model));
}

TEST(ModelJson, WritesAFigureThatDoesNotExistAsNullAndReadsItAsNan) {
  EquipmentModel model = example_model();
  model.validation.fit_percent(0) = -std::numeric_limits<double>::infinity();
  const auto json = to_json(model);
  EXPECT_TRUE(json["validation"]["fit_percent"][0].is_null());
  EXPECT_TRUE(std::isnan(equipment_model_from_json(json.dump()).validation.fit_percent(0)));
}

TEST(ModelJson, HasNoKeyForWhatAModelDoesNotHave) {
  const auto json = to_json(example_model());
  EXPECT_FALSE(json.contains("tracking"));
  EXPECT_FALSE(json["inputs"][0].contains("expression"));
}

TEST(ModelJson, KeepsEveryField) {
  const EquipmentModel model = distinct_version().model;
  const EquipmentModel back = equipment_model_from_json(to_json(model).dump());
  EXPECT_THAT(differing_fields(back, model), testing::IsEmpty());
}

struct Damage {
  const char* pointer;  // JSON pointer to what is replaced; by null in `value`: removed
  const char* value;
  const char* message;
};

class DamagedModelJson : public testing::TestWithParam<Damage> {};

TEST_P(DamagedModelJson, IsRefusedWithTheNameOfTheField) {
  auto json = to_json(full_example_model());
  const nlohmann::ordered_json::json_pointer pointer(GetParam().pointer);
  if (GetParam().value == nullptr) {
    json.at(pointer.parent_pointer()).erase(pointer.back());
  } else {
    json[pointer] = nlohmann::ordered_json::parse(GetParam().value);
  }
  try {
    equipment_model_from_json(json.dump());
    FAIL() << "it was taken";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(GetParam().message));
  }
}

INSTANTIATE_TEST_SUITE_P(
    table, DamagedModelJson,
    testing::Values(Damage{"/A", nullptr, "\"A\" is missing"},
                    Damage{"/A", "3", "\"A\" must be an array"},
                    Damage{"/A", "[[1]]", "\"order\" is 2 and A has 1 rows"},
                    Damage{"/A/1", "[1]", "\"A[1]\" must have 2 entries and has 1"},
                    Damage{"/B", "[[1,2]]", "\"B\" must have 2 entries and has 1"},
                    Damage{"/C/0/1", "\"x\"", "\"C[0][1]\" must be a number or null"},
                    Damage{"/K", "[[1],[2],[3]]", "\"K\" must have 2 entries and has 3"},
                    Damage{"/input_offset", "[1]", "\"input_offset\" must have 2 entries"},
                    Damage{"/hold_ns", "1.5", "\"hold_ns\" must be an integer"},
                    Damage{"/hold_ns", "9223372036854775808", "\"hold_ns\" is above"},
                    Damage{"/inputs/1/name", "7", "\"inputs[1].name\" must be a string"},
                    Damage{"/validated_on", "[]", "\"validated_on\" must be an object"},
                    Damage{"/inputs/1/expression", "1", "\"inputs[1].expression\" must be a str"},
                    Damage{"/inputs/1/expression", "\"V_BUS *\"",
                           "\"inputs[1].expression\" at byte 8: a number"},
                    Damage{"/tracking/state", "[[1,2]]", "\"tracking.state\" must have 2 entr"},
                    Damage{"/tracking/integral/0", "[1]", "\"tracking.integral[0]\" must have 2"},
                    Damage{"/tracking/error_limit", "[]", "\"tracking.error_limit\" must have 1"},
                    Damage{"/tracking/validation", nullptr, "\"tracking.validation\" is missing"},
                    Damage{"/validation/rows", nullptr, "\"validation.rows\" is missing"}));

// Registries and simulators' files hold this text: it stays as it is, to the last byte.
TEST(ModelJson, IsTheTextThatItAlwaysWas) {
  EXPECT_EQ(to_json(full_example_model()).dump(),
            R"({"spacecraft":"CBERS4","equipment":"BDR",)"
            R"("inputs":[{"name":"I_BDRIN1","unit":"A","low":0.0,"high":5.0},)"
            R"({"name":"P_IN","unit":"W","low":-0.25,"high":4.0,"expression":"V_BUS * I_BDRIN2"}],)"
            R"("outputs":[{"name":"I_BDROUT","unit":"A","low":0.0,"high":10.0}],)"
            R"("order":2,"sample_period_s":1.0,"hold_ns":3000000000,"A":[[0.9,0.1],[-0.2,0.7]],)"
            R"("B":[[0.5,0.25],[0.125,0.3333333333333333]],"C":[[1.0,-0.5]],"D":[[0.1,0.0]],)"
            R"("K":[[0.3],[0.2]],"input_offset":[2.5,1.5],"output_offset":[4.25],)"
            R"("identified_from":{"begin_ns":1000,"end_ns":5000},)"
            R"("validated_on":{"begin_ns":5000,"end_ns":7000},)"
            R"("validation":{"mrse_percent":[6.9],"fit_percent":[81.5],"rows":2000},)"
            R"("method":"N4SID, horizon 12, order 2",)"
            R"("tracking":{"state":[[0.5,-1.0],[0.3333333333333333,0.0]],)"
            R"("integral":[[0.1,0.2],[-0.3,0.7]],"error_limit":[2.5],)"
            R"("validation":{"mrse_percent":[0.5],"fit_percent":[99.0],"rows":2000}}})");
}

TEST(ModelJson, RefusesTextThatIsNotJson) {
  EXPECT_THROW(equipment_model_from_json("{\"A\": [1, "), std::invalid_argument);
  EXPECT_THROW(equipment_model_from_json("[]"), std::invalid_argument);
}

}  // namespace
}  // namespace reident::test::model_json_test
