// What can be exported, and the texts of it that are ours to read back.
#include "service/model_export/model_export.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "service/model_export/fmu_text.hpp"
#include "service/model_export/units.hpp"
#include "tests/service/model/example_model.hpp"
#include "tests/service/model_export/export_fixture.hpp"

namespace reident::test::model_export_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(ModelExport, NeedsAModelThatIsWhole) {
  const ModelVersion sound = random_version({2, 2, 1}, 1).version;
  EXPECT_EQ(model_export::obstacle(sound), std::nullopt);
  ModelVersion damaged = sound;
  damaged.model.dynamics.A(0, 0) += 1e-9;
  EXPECT_THAT(model_export::obstacle(damaged).value_or(""), HasSubstr("does not match its digest"));
  damaged.model.dynamics.u0(0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(model_export::obstacle(damaged).value_or(""), HasSubstr("not finite"));
  ModelVersion ambiguous = sound;
  ambiguous.model.outputs[0].name = ambiguous.model.inputs[1].name;
  ambiguous.digest = model_digest(ambiguous.model);
  EXPECT_THAT(model_export::obstacle(ambiguous).value_or(""), HasSubstr("are called I_1"));
}

TEST(ModelExport, WritesJsonThatIsTheModelToTheLastBit) {
  const auto exported = random_version({4, 3, 2, true, 0.1, {"U * I_2"}}, 2);
  const auto object = nlohmann::ordered_json::parse(model_export::json_file(exported));
  EXPECT_EQ(object["version"], 7);
  EXPECT_EQ(object["decided"], "2023-11-14T22:13:20Z");
  const EquipmentModel model = equipment_model_from_json(object["model"].dump());
  EXPECT_EQ(model_digest(model), exported.version.digest);
  EXPECT_EQ(object["digest"], exported.version.digest);
}

TEST(ModelExport, WritesTheJsonThatItAlwaysWrote) {
  const model_export::ExportedVersion exported{example_version(3), "superseded"};
  auto object = nlohmann::ordered_json::parse(model_export::json_file(exported));
  EXPECT_EQ(object["model"].dump(), to_json(exported.version.model).dump());
  object["model"] = nullptr;
  EXPECT_EQ(object.dump(),
            R"({"format":"reident model version 1","spacecraft":"CBERS4","equipment":"BDR",)"
            R"("version":3,)"
            R"("digest":"17910f60ef1713b1804a8bb1ac83963863c0cef758d0f6d27535e0d025323a45",)"
            R"("status":"superseded","decided":"1970-01-01T00:00:00.000000042Z",)"
            R"("decided_by":"gate","program_version":"0.1.0","model":null})");
}

TEST(FmuVariables, AreTheParametersBehindTheInputs) {
  auto version = random_version({1, 3, 2, true, 1, {"U * I_2"}}, 3).version;
  version.model.dynamics.D << 0, 1, 0, 2, 0, 0;
  const auto variables = model_export::fmu_variables(version.model);
  ASSERT_EQ(variables.inputs.size(), 3U);
  EXPECT_EQ(variables.inputs[0].name, "U");
  EXPECT_EQ(variables.inputs[0].unit, "");
  EXPECT_EQ(variables.inputs[0].start, 1);
  EXPECT_EQ(variables.inputs[1].name, "I_2");
  EXPECT_EQ(variables.inputs[1].unit, "A");
  EXPECT_EQ(variables.inputs[1].start, version.model.dynamics.u0(2));
  EXPECT_EQ(variables.inputs[2].name, "I_1");
  EXPECT_THAT(variables.direct, ElementsAre(ElementsAre(2U), ElementsAre(0U, 1U)));
}

TEST(FmuText, NamesAModelAsCCan) {
  ModelVersion version;
  version.number = 12;
  version.model.spacecraft = "CBERS-4";
  version.model.equipment = "BAT µ.1";
  EXPECT_EQ(model_export::model_identifier(version), "CBERS_4_BAT____1_v12");
  version.model.spacecraft = "4 sats" + std::string(300, 'x');
  EXPECT_THAT(model_export::model_identifier(version), ::testing::StartsWith("model_4_sats"));
  EXPECT_EQ(model_export::model_identifier(version).size(), 104U);
  EXPECT_EQ(model_export::xml_text("a<b & \"c\">\n"), "a&lt;b &amp; &quot;c&quot;&gt; ");
}

TEST(Units, AreKnownWithTheirPrefixes) {
  EXPECT_EQ(model_export::base_unit("mV")->factor, 1e-3);
  EXPECT_EQ(model_export::base_unit("mV")->powers.size(), 4U);
  EXPECT_EQ(model_export::base_unit("Ah")->factor, 3600);
  EXPECT_EQ(model_export::base_unit("degC")->offset, 273.15);
  EXPECT_EQ(model_export::base_unit("m")->factor, 1);
  EXPECT_FALSE(model_export::base_unit("mdegC"));
  EXPECT_FALSE(model_export::base_unit("counts"));
  EXPECT_FALSE(model_export::base_unit("m%"));
}

}  // namespace
}  // namespace reident::test::model_export_test
