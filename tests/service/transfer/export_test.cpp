#include "service/transfer/export.hpp"

#include "tests/service/transfer/transfer_fixture.hpp"

namespace reident::transfer::export_test {
namespace {

using storage::Origin;
using storage::Quality;
using storage::Time;
using ::testing::HasSubstr;

constexpr Time second = 1'000'000'000;
constexpr Time t0 = 1'700'000'000 * second;  // 2023-11-14T22:13:20Z

class ExportTest : public storage::test::ArchiveTest {
 protected:
  ExportTest() {
    archive.describe(
        {{test::descriptor("CB4", 1, "V_BUS", "V"), test::descriptor("CB4", 2, "I_BUS", "A")}});
  }
  void send(Time time, std::vector<storage::Sample> samples) {
    append({storage::test::frame(++sequence_, time, std::move(samples))});
  }
  std::uint64_t sequence_ = 0;
};

TEST_F(ExportTest, HasASampleARowWithAllThatIsKnownOfIt) {
  send(t0, {{1, Quality::good, 28.1}, {2, Quality::suspect, -0.0}, {9, Quality::good, 1}});
  send(t0 + second / 2, {{1, Quality::good, std::numeric_limits<double>::quiet_NaN()}});
  for (const bool compacted : {false, true}) {
    if (compacted) archive.compact();
    EXPECT_EQ(test::exported(database),
              "spacecraft,parameter,origin,source,time,value,quality,unit\n"
              "CB4,9,real,station,2023-11-14T22:13:20Z,1,good,\n"
              "CB4,I_BUS,real,station,2023-11-14T22:13:20Z,-0,suspect,A\n"
              "CB4,V_BUS,real,station,2023-11-14T22:13:20Z,28.1,good,V\n"
              "CB4,V_BUS,real,station,2023-11-14T22:13:20.5Z,nan,invalid,V\n");
  }
}

TEST_F(ExportTest, WideJoinsTheSeriesOnTheirTimes) {
  send(t0, {{1, Quality::good, 28.1}, {2, Quality::good, 3}});
  send(t0 + second, {{1, Quality::good, 28.2}});
  send(t0 + 2 * second, {{2, Quality::good, 4}});
  ExportOptions options = test::everything();
  options.wide = true;
  EXPECT_EQ(test::exported(database, options),
            "time,I_BUS,V_BUS\n2023-11-14T22:13:20Z,3,28.1\n2023-11-14T22:13:21Z,,28.2\n"
            "2023-11-14T22:13:22Z,4,\n");
  options.parameters = {"V_BUS", "I_BUS"};
  EXPECT_THAT(test::exported(database, options), ::testing::StartsWith("time,V_BUS,I_BUS\n"));
}

TEST_F(ExportTest, IsBoundedByTimeParameterAndOrigin) {
  for (int i = 0; i < 10; ++i) send(t0 + i * second, {{1, Quality::good, 1.0 * i}});
  auto simulated = storage::test::frame(1, t0, {{2, Quality::good, 77}});
  simulated.origin = Origin::simulated;
  append({simulated});
  ExportOptions options = test::everything();
  options.range = {t0 + 2 * second, t0 + 4 * second};
  EXPECT_EQ(test::exported(database, options),
            "spacecraft,parameter,origin,source,time,value,quality,unit\n"
            "CB4,V_BUS,real,station,2023-11-14T22:13:22Z,2,good,V\n"
            "CB4,V_BUS,real,station,2023-11-14T22:13:23Z,3,good,V\n");
  options = test::everything();
  options.origin = Origin::simulated;
  EXPECT_THAT(test::exported(database, options), HasSubstr("I_BUS,simulated,station"));
  EXPECT_THAT(test::exported(database, options), ::testing::Not(HasSubstr("real")));
}

TEST_F(ExportTest, RefusesWhatTheArchiveDoesNotHave) {
  EXPECT_EQ(test::exported(database), "there is no telemetry in the archive");
  send(t0, {{1, Quality::good, 1}});
  ExportOptions options = test::everything();
  options.spacecraft = "CB5";
  EXPECT_EQ(test::exported(database, options), "the archive has no spacecraft 'CB5'; it has CB4");
  options = test::everything();
  options.parameters = {"V_BUZ"};
  EXPECT_EQ(test::exported(database, options),
            "the archive has no parameter 'V_BUZ'; it has V_BUS");
}

TEST_F(ExportTest, WideRefusesWhatHasTwoPlacesInARow) {
  send(t0, {{1, Quality::good, 1}});
  auto other = storage::test::frame(1, t0, {{1, Quality::good, 1}});
  other.origin = Origin::simulated;
  append({other});
  ExportOptions options = test::everything();
  options.wide = true;
  EXPECT_THAT(test::exported(database, options), HasSubstr("say --origin real or"));
  other.spacecraft = "CB5";
  append({other});
  EXPECT_THAT(test::exported(database, options), HasSubstr("with --spacecraft"));
}

}  // namespace
}  // namespace reident::transfer::export_test
