#include "service/satcs/gateway/xtce_reader.hpp"

#include <gmock/gmock.h>

#include "service/satcs/gateway/packet_stream.hpp"
#include "tests/service/satcs/gateway/xtce_text.hpp"

namespace reident::test::xtce_reader_test {
namespace {

using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

std::string error_of(const std::string& text) {
  const auto read = read_xtce(text);
  const auto* error = std::get_if<csv::Error>(&read);
  return error ? error->message : "no error";
}

TEST(XtceReader, SaysWhereAFileIsNoDatabase) {
  EXPECT_THAT(error_of("<a>\n<b>\n</a>\n"), HasSubstr("line 3: is no XML"));
  EXPECT_THAT(error_of(""), HasSubstr("is no XML"));
  EXPECT_THAT(error_of("\n<html/>"), HasSubstr("line 2: the root is 'html'"));
  EXPECT_THAT(error_of("<SpaceSystem name='S'/>"), HasSubstr("no container can be a packet"));
  EXPECT_THAT(std::get<csv::Error>(satcs::xtce::read_database("/nowhere.xml")).message,
              HasSubstr("/nowhere.xml: cannot be read"));
}

TEST(XtceReader, OpensNoOtherFile) {
  const TemporaryFolder folder;
  std::ofstream(folder / "secret") << "secret";
  const auto database = database_of(
      "<!DOCTYPE SpaceSystem [<!ENTITY x SYSTEM 'file://" + (folder / "secret").string() + "'>]>" +
      xtce_text("",
                "<Parameter name='X' parameterTypeRef='Byte'><LongDescription>&x;"
                "</LongDescription></Parameter>",
                "<ParameterRefEntry parameterRef='X'/>"));
  EXPECT_EQ(database.parameters.back().description.find("secret"), std::string::npos);
}

struct UnknownThing {
  const char* types;
  const char* entries;
  const char* path;  // its end
  bool is_published;
};

TEST(XtceReader, NamesWhatItDoesNotKnowWithItsLineAndPath) {
  for (const auto& [types, entries, path, is_published] : {
           UnknownThing{"<IntegerParameterType name='T'>\n<IntegerDataEncoding "
                        "encoding='packedBCD'/></IntegerParameterType>",
                        "", "IntegerParameterType[T]/IntegerDataEncoding", false},
           UnknownThing{"<FloatParameterType name='T'><IntegerDataEncoding>\n<DefaultCalibrator>"
                        "<MathOperationCalibrator/></DefaultCalibrator></IntegerDataEncoding>"
                        "</FloatParameterType>",
                        "", "DefaultCalibrator/MathOperationCalibrator", false},
           UnknownThing{"<FloatParameterType name='T'>\n<FloatDataEncoding sizeInBits='128'/>"
                        "</FloatParameterType>",
                        "", "FloatDataEncoding", false},
           UnknownThing{"<IntegerParameterType name='T'><IntegerDataEncoding/>\n<ContextAlarmList/>"
                        "</IntegerParameterType>",
                        "", "IntegerParameterType[T]/ContextAlarmList", true},
           UnknownThing{
               "<IntegerParameterType name='T'><IntegerDataEncoding/></IntegerParameterType>",
               "<ArrayParameterRefEntry parameterRef='X'/>", "ArrayParameterRefEntry[X]", true},
           UnknownThing{
               "<IntegerParameterType name='T'><IntegerDataEncoding/></IntegerParameterType>",
               "<ParameterRefEntry parameterRef='NONE'/>", "ParameterRefEntry[NONE]", true},
           UnknownThing{
               "<IntegerParameterType name='T'><IntegerDataEncoding/></IntegerParameterType>",
               "<ParameterRefEntry parameterRef='X'><RepeatEntry/></ParameterRefEntry>",
               "ParameterRefEntry[X]/RepeatEntry", true},
       }) {
    const auto database =
        database_of(xtce_text(types, "<Parameter name='X' parameterTypeRef='T'/>\n",
                              "<ParameterRefEntry parameterRef='X'/>" + std::string(entries)));
    ASSERT_EQ(database.notes.size(), 1U) << path;
    EXPECT_THAT(database.notes[0].path, EndsWith(path));
    EXPECT_EQ(database.notes[0].line, *entries == '\0' ? 6 : 11) << path;
    EXPECT_EQ(database.published.size(), is_published ? 2U : 1U) << path;
  }
}

TEST(XtceReader, FindsReferencesFromTheInnermostSystemOut) {
  const std::string type =
      "<ParameterTypeSet><IntegerParameterType name='U8'><UnitSet><Unit>V</Unit></UnitSet>"
      "<IntegerDataEncoding/></IntegerParameterType></ParameterTypeSet>";
  const std::string header =
      "<ParameterTypeSet><IntegerParameterType name='H'><IntegerDataEncoding sizeInBits='48'/>"
      "</IntegerParameterType><IntegerParameterType name='U8'><UnitSet><Unit>A</Unit></UnitSet>"
      "<IntegerDataEncoding/></IntegerParameterType></ParameterTypeSet>";
  const std::string parameters =
      "<ParameterSet><Parameter name='H' parameterTypeRef='H'/><Parameter name='X' "
      "parameterTypeRef='U8'/><Parameter name='Y' parameterTypeRef='U8'/></ParameterSet>";
  const std::string container =
      "<ContainerSet><SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='H'/>"
      "<ParameterRefEntry parameterRef='X'/><ParameterRefEntry parameterRef='/S/EPS/X'/>"
      "<ParameterRefEntry parameterRef='EPS/Z'/></EntryList></SequenceContainer></ContainerSet>";
  const auto database = database_of(
      "<SpaceSystem name='S'><TelemetryMetaData>" + header + parameters + container +
      "</TelemetryMetaData><SpaceSystem name='EPS'><TelemetryMetaData>" + type +
      "<ParameterSet><Parameter name='X' parameterTypeRef='U8'/><Parameter name='Z' "
      "parameterTypeRef='../U8'/></ParameterSet></TelemetryMetaData></SpaceSystem></SpaceSystem>");
  EXPECT_TRUE(database.notes.empty());
  const auto parameters_of = satcs::gateway_parameters(database, {});
  std::vector<std::string> names;
  for (const auto& one : std::get<std::vector<satcs::GatewayParameter>>(parameters_of))
    names.push_back(one.descriptor.name + " " + one.descriptor.unit);
  EXPECT_THAT(names, ElementsAre("X A", "EPS.X V", "Z A"));
}

TEST(XtceReader, IsNotLedInCircles) {
  const std::string circle =
      "<SequenceContainer name='A'><EntryList/><BaseContainer "
      "containerRef='B'/></SequenceContainer>"
      "<SequenceContainer name='B'><EntryList/><BaseContainer "
      "containerRef='A'/></SequenceContainer>"
      "<SequenceContainer name='C'><EntryList><ContainerRefEntry containerRef='C'/></EntryList>"
      "</SequenceContainer>";
  const auto database = database_of(xtce_text("", "", "", circle));
  EXPECT_FALSE(database.notes.empty());
  satcs::PacketDecoder decoder(database);
  std::vector<storage::Sample> samples;
  EXPECT_EQ(decoder.decode(packet_of({1}), samples).outcome,
            satcs::DecodedPacket::Outcome::complete);
}

TEST(XtceReader, DescribesParametersForTheArchive) {
  const auto read = satcs::xtce::read_database(EPS_XTCE);
  const auto& database = std::get<satcs::xtce::Database>(read);
  EXPECT_TRUE(database.notes.empty());
  const auto chosen = satcs::gateway_parameters(database, {"V_BUS", "BAT1_MODE"});
  const auto& parameters = std::get<std::vector<satcs::GatewayParameter>>(chosen);
  ASSERT_EQ(parameters.size(), 2U);
  const auto& mode = parameters[0].descriptor;
  EXPECT_EQ(mode.kind, storage::ParameterKind::digital);
  EXPECT_THAT(mode.description, HasSubstr("states OFF=0, CHARGE=1, DISCHARGE=2"));
  const auto& bus = parameters[1].descriptor;
  EXPECT_EQ(bus.unit, "V");
  EXPECT_EQ(bus.description, "Main bus voltage");
  EXPECT_EQ(bus.low_limit, 26);
  EXPECT_EQ(bus.high_limit, 30);
  EXPECT_THAT(std::get<csv::Error>(satcs::gateway_parameters(database, {"V_BUSS"})).message,
              HasSubstr("'V_BUSS'"));
}

}  // namespace
}  // namespace reident::test::xtce_reader_test
