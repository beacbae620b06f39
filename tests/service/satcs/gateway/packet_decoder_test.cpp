#include "service/satcs/gateway/packet_decoder.hpp"

#include <cmath>
#include <map>
#include <random>

#include <gmock/gmock.h>

#include "tests/service/satcs/gateway/xtce_text.hpp"

namespace reident::test::packet_decoder_test {
namespace {

using satcs::DecodedPacket;
using satcs::PacketDecoder;
using storage::Quality;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;
using Values = std::vector<std::pair<std::string, double>>;
using Outcome = DecodedPacket::Outcome;

class Decoded {
 public:
  Decoded(const satcs::xtce::Database& database, const std::vector<std::uint8_t>& data) {
    PacketDecoder decoder(database);
    std::vector<storage::Sample> samples;
    packet = decoder.decode(packet_of(data), samples);
    for (const storage::Sample& sample : samples) {
      const std::string& name = database.parameters[sample.parameter].name;
      values.emplace_back(name, sample.value);
      qualities[name] = sample.quality;
    }
  }
  DecodedPacket packet;
  Values values;
  std::map<std::string, Quality> qualities;
};

std::string entry(const std::string& name, const std::string& inner = {}) {
  return "<ParameterRefEntry parameterRef='" + name + "'>" + inner + "</ParameterRefEntry>";
}

std::string parameter(const std::string& name, const std::string& type) {
  return "<Parameter name='" + name + "' parameterTypeRef='" + type + "'/>";
}

std::string calibrated_type(const std::string& calibrator, const std::string& more = {}) {
  return "<FloatParameterType name='T'><IntegerDataEncoding sizeInBits='8' "
         "encoding='twosComplement'><DefaultCalibrator>" +
         calibrator + "</DefaultCalibrator></IntegerDataEncoding>" + more + "</FloatParameterType>";
}

double calibrated_value(const std::string& calibrator, std::uint8_t raw) {
  const auto database =
      database_of(xtce_text(calibrated_type(calibrator), parameter("X", "T"), entry("X")));
  EXPECT_TRUE(database.notes.empty());
  const Decoded decoded(database, {0, raw});
  EXPECT_EQ(decoded.values.size(), 2U);
  return decoded.values.back().second;
}

TEST(PacketDecoder, CalibratesByPolynomialAndSpline) {
  const std::string polynomial =
      "<PolynomialCalibrator><Term coefficient='2' exponent='2'/><Term coefficient='-1.5' "
      "exponent='0'/></PolynomialCalibrator>";
  EXPECT_EQ(calibrated_value(polynomial, 3), 16.5);
  EXPECT_EQ(calibrated_value(polynomial, 0xfd), 16.5);
  const auto spline = [](const std::string& options) {
    return "<SplineCalibrator " + options +
           "><SplinePoint raw='20' calibrated='400'/><SplinePoint raw='0' calibrated='0'/>"
           "<SplinePoint raw='10' calibrated='100'/></SplineCalibrator>";
  };
  EXPECT_EQ(calibrated_value(spline(""), 0), 0);
  EXPECT_EQ(calibrated_value(spline(""), 5), 50);
  EXPECT_EQ(calibrated_value(spline(""), 10), 100);
  EXPECT_EQ(calibrated_value(spline(""), 15), 250);
  EXPECT_EQ(calibrated_value(spline(""), 20), 400);
  EXPECT_TRUE(std::isnan(calibrated_value(spline(""), 21)));
  EXPECT_TRUE(std::isnan(calibrated_value(spline(""), 0xff)));
  EXPECT_EQ(calibrated_value(spline("extrapolate='true'"), 21), 430);
  EXPECT_EQ(calibrated_value(spline("extrapolate='true'"), 0xff), -10);
  EXPECT_EQ(calibrated_value(spline("order='0'"), 9), 0);
  EXPECT_EQ(calibrated_value(spline("order='0'"), 20), 400);
}

TEST(PacketDecoder, FlagsByAlarmsAndValidRange) {
  const std::string limits =
      "<DefaultAlarm><StaticAlarmRanges><WarningRange minInclusive='-5' maxExclusive='10'/>"
      "<CriticalRange minInclusive='-8' maxInclusive='20'/></StaticAlarmRanges></DefaultAlarm>"
      "<ValidRange maxInclusive='100'/>";
  const auto database = database_of(
      xtce_text(calibrated_type("<PolynomialCalibrator><Term coefficient='1' exponent='1'/>"
                                "</PolynomialCalibrator>",
                                limits),
                parameter("X", "T"), entry("X")));
  const std::map<std::uint8_t, Quality> expected = {{0, Quality::good},
                                                    {9, Quality::good},
                                                    {10, Quality::out_of_limits},
                                                    {0xfb, Quality::good},
                                                    {0xfa, Quality::out_of_limits},
                                                    {100, Quality::out_of_limits},
                                                    {101, Quality::invalid}};
  for (const auto& [raw, quality] : expected)
    EXPECT_EQ(Decoded(database, {0, raw}).qualities.at("X"), quality) << int{raw};
}

const char* const states =
    "<EnumeratedParameterType name='Mode'><IntegerDataEncoding sizeInBits='4'/><EnumerationList>"
    "<Enumeration value='1' label='OFF'/><Enumeration value='4' maxValue='0x6' label='ON'/>"
    "</EnumerationList></EnumeratedParameterType>"
    "<BooleanParameterType name='Flag'><IntegerDataEncoding "
    "sizeInBits='4'/></BooleanParameterType>";

TEST(PacketDecoder, GivesStatesAsNumbersAndDoubtsOneWithoutALabel) {
  const auto database = database_of(
      xtce_text(states, parameter("M", "Mode") + parameter("F", "Flag"), entry("M") + entry("F")));
  const Decoded on(database, {0, 0x57});
  EXPECT_THAT(on.values, ElementsAre(Pair("KIND", 0), Pair("M", 5), Pair("F", 1)));
  EXPECT_EQ(on.qualities.at("M"), Quality::good);
  EXPECT_EQ(Decoded(database, {0, 0x20}).qualities.at("M"), Quality::suspect);
}

TEST(PacketDecoder, TakesAConditionInEachForm) {
  const auto has_x = [](const std::string& condition, std::uint8_t kind, std::uint8_t mode) {
    const auto database = database_of(
        xtce_text(states, parameter("M", "Mode") + parameter("F", "Flag") + parameter("X", "Byte"),
                  entry("M") + entry("F") +
                      entry("X", "<IncludeCondition>" + condition + "</IncludeCondition>")));
    EXPECT_TRUE(database.notes.empty());
    return Decoded(database, {kind, mode, 9}).values.size() == 4;
  };
  const auto comparison = [](const std::string& of, const std::string& value,
                             const std::string& op = "==", const std::string& more = {}) {
    return "<Comparison parameterRef='" + of + "' value='" + value + "' comparisonOperator='" + op +
           "' " + more + "/>";
  };
  EXPECT_TRUE(has_x(comparison("KIND", "7"), 7, 0x10));
  EXPECT_FALSE(has_x(comparison("KIND", "7"), 8, 0x10));
  EXPECT_TRUE(has_x(comparison("KIND", "7", "&gt;="), 8, 0x10));
  EXPECT_FALSE(has_x(comparison("KIND", "7", "!="), 7, 0x10));
  EXPECT_TRUE(has_x(comparison("M", "ON"), 0, 0x60));
  EXPECT_FALSE(has_x(comparison("M", "ON"), 0, 0x10));
  EXPECT_TRUE(has_x(comparison("M", "ON", "!="), 0, 0x10));
  EXPECT_TRUE(has_x(comparison("M", "4", "==", "useCalibratedValue='false'"), 0, 0x40));
  EXPECT_TRUE(has_x(comparison("F", "True"), 0, 0x13));
  EXPECT_FALSE(has_x(comparison("X", "0"), 0, 0x10)) << "it has not come yet";
  const std::string both = comparison("KIND", "1") + comparison("M", "OFF");
  EXPECT_TRUE(has_x("<ComparisonList>" + both + "</ComparisonList>", 1, 0x10));
  EXPECT_FALSE(has_x("<ComparisonList>" + both + "</ComparisonList>", 2, 0x10));
  const auto condition = [](const std::string& value) {
    return "<Condition><ParameterInstanceRef parameterRef='KIND'/><ComparisonOperator>==</"
           "ComparisonOperator><Value>" +
           value + "</Value></Condition>";
  };
  const std::string any = "<BooleanExpression><ORedConditions>" + condition("1") + condition("2") +
                          "</ORedConditions></BooleanExpression>";
  EXPECT_TRUE(has_x(any, 2, 0x10));
  EXPECT_FALSE(has_x(any, 3, 0x10));
  EXPECT_FALSE(has_x("<BooleanExpression><ANDedConditions>" + condition("1") + condition("2") +
                         "</ANDedConditions></BooleanExpression>",
                     1, 0x10));
}

std::string heir(const std::string& name, const std::string& base, const std::string& criteria,
                 const std::string& entries, const std::string& more = {}) {
  return "<SequenceContainer name='" + name + "' " + more + "><EntryList>" + entries +
         "</EntryList><BaseContainer containerRef='" + base + "'>" +
         (criteria.empty() ? "" : "<RestrictionCriteria>" + criteria + "</RestrictionCriteria>") +
         "</BaseContainer></SequenceContainer>";
}

TEST(PacketDecoder, FollowsInheritanceByTheCriteria) {
  const auto kind = [](const std::string& value) {
    return "<Comparison parameterRef='KIND' value='" + value + "'/>";
  };
  const std::string heirs =
      heir("A", "P", kind("1"), entry("X")) + heir("B", "P", kind("2"), "", "abstract='true'") +
      heir("C", "B", "<Comparison parameterRef='KIND' value='2'/>", entry("Y")) +
      heir("D", "P", kind("3"), entry("X"), "abstract='true'");
  const auto database =
      database_of(xtce_text("", parameter("X", "Byte") + parameter("Y", "Byte"), "", heirs));
  EXPECT_THAT(Decoded(database, {1, 8}).values, ElementsAre(Pair("KIND", 1), Pair("X", 8)));
  EXPECT_THAT(Decoded(database, {2, 8}).values, ElementsAre(Pair("KIND", 2), Pair("Y", 8)));
  EXPECT_EQ(Decoded(database, {3, 8}).packet.outcome, Outcome::no_container);
  EXPECT_EQ(Decoded(database, {9, 8}).packet.outcome, Outcome::complete) << "P itself";
  EXPECT_EQ(Decoded(database, {9, 8}).packet.bits_left, 8U);
}

TEST(PacketDecoder, SaysWhichParameterIsBeyondTheEnd) {
  const auto database = database_of(xtce_text("", parameter("X", "Byte"), entry("X")));
  const Decoded decoded(database, {1});
  EXPECT_EQ(decoded.packet.outcome, Outcome::too_short);
  EXPECT_THAT(decoded.packet.detail, HasSubstr("X needs bits 56 to 64, there are 56"));
}

TEST(PacketDecoder, FindsEntriesByTheirPlace) {
  const std::string place =
      "<LocationInContainerInBits referenceLocation='containerStart'><FixedValue>72</FixedValue>"
      "</LocationInContainerInBits>";
  const std::string back =
      "<LocationInContainerInBits><FixedValue>-16</FixedValue>"
      "</LocationInContainerInBits>";
  const auto database = database_of(xtce_text("", parameter("X", "Byte") + parameter("Y", "Byte"),
                                              entry("X", place) + entry("Y", back)));
  EXPECT_THAT(Decoded(database, {1, 2, 3, 4}).values,
              ElementsAre(Pair("KIND", 1), Pair("X", 4), Pair("Y", 3)));
}

/// An aggregate, a binary whose size a packet says, and a text up to a terminator.
satcs::xtce::Database sized_by_packets() {
  const std::string types =
      "<AggregateParameterType name='Pair'><MemberList><Member name='a' typeRef='Byte'/><Member "
      "name='b' typeRef='Byte'/></MemberList></AggregateParameterType>"
      "<BinaryParameterType name='Blob'><BinaryDataEncoding><SizeInBits><DynamicValue>"
      "<ParameterInstanceRef parameterRef='V/b'/><LinearAdjustment slope='8' intercept='-8'/>"
      "</DynamicValue></SizeInBits></BinaryDataEncoding></BinaryParameterType>"
      "<StringParameterType name='Text'><StringDataEncoding><Variable maxSizeInBits='800'>"
      "<TerminationChar>00</TerminationChar></Variable></StringDataEncoding></StringParameterType>";
  const std::string parameters = parameter("V", "Pair") + parameter("B", "Blob") +
                                 parameter("T", "Text") + parameter("X", "Byte");
  const std::string inner = "<SequenceContainer name='Inner'><EntryList>" + entry("V") +
                            entry("B") + "</EntryList></SequenceContainer>";
  return database_of(
      xtce_text(types, parameters,
                "<ContainerRefEntry containerRef='Inner'/>" + entry("T") + entry("X"), inner));
}

TEST(PacketDecoder, ReadsAggregatesIncludedContainersAndSizesThatPacketsSay) {
  const auto database = sized_by_packets();
  EXPECT_TRUE(database.notes.empty());
  EXPECT_EQ(database.roots.size(), 1U);
  EXPECT_THAT(Decoded(database, {1, 7, 3, 0xee, 0xee, 'A', 'B', 0, 5}).values,
              ElementsAre(Pair("KIND", 1), Pair("V.a", 7), Pair("V.b", 3), Pair("X", 5)));
  EXPECT_EQ(Decoded(database, {1, 7, 1, 'A'}).packet.outcome, Outcome::too_short);
}

TEST(PacketDecoder, ReadsNothingBeyondAnyPacket) {
  const auto eps = satcs::xtce::read_database(EPS_XTCE);
  std::mt19937 random(1);
  for (const auto& database : {sized_by_packets(), std::get<satcs::xtce::Database>(eps)}) {
    PacketDecoder decoder(database);
    std::vector<storage::Sample> samples;
    std::map<Outcome, int> outcomes;
    for (int i = 0; i < 20'000; ++i) {
      std::vector<std::uint8_t> data(1 + random() % 40);
      for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random() % 4);
      // A copy that ends with its bytes, for sanitizers.
      const std::vector<std::uint8_t> packet = packet_of(data, 0, 100);
      ++outcomes[decoder.decode(packet, samples).outcome];
    }
    EXPECT_GT(outcomes[Outcome::complete], 100);
    EXPECT_GT(outcomes[Outcome::too_short], 100);
  }
}

TEST(PacketDecoder, LeavesOutWhatStandsBehindAnEntryOfUnknownSize) {
  const auto database = database_of(xtce_text(
      "", parameter("X", "Byte") + parameter("Y", "Byte"),
      "<StreamSegmentEntry streamRef='Z' sizeInBits='8'/>" + entry("X") +
          entry("Y",
                "<LocationInContainerInBits referenceLocation='containerStart'><FixedValue>64"
                "</FixedValue></LocationInContainerInBits>")));
  EXPECT_EQ(database.notes.size(), 1U);
  EXPECT_THAT(Decoded(database, {1, 2, 3}).values, ElementsAre(Pair("KIND", 1), Pair("Y", 3)));
}

TEST(PacketDecoder, ChoosesACalibratorByItsContext) {
  const std::string type =
      "<FloatParameterType name='T'><IntegerDataEncoding sizeInBits='8'><DefaultCalibrator>"
      "<PolynomialCalibrator><Term coefficient='10' exponent='1'/></PolynomialCalibrator>"
      "</DefaultCalibrator><ContextCalibratorList><ContextCalibrator><ContextMatch><Comparison "
      "parameterRef='KIND' value='2'/></ContextMatch><Calibrator><PolynomialCalibrator><Term "
      "coefficient='100' exponent='1'/></PolynomialCalibrator></Calibrator></ContextCalibrator>"
      "</ContextCalibratorList></IntegerDataEncoding></FloatParameterType>";
  const auto database = database_of(xtce_text(type, parameter("X", "T"), entry("X")));
  EXPECT_EQ(Decoded(database, {1, 3}).values.back().second, 30);
  EXPECT_EQ(Decoded(database, {2, 3}).values.back().second, 300);
}

}  // namespace
}  // namespace reident::test::packet_decoder_test
