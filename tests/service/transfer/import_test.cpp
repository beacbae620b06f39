#include "service/transfer/import.hpp"

#include <cmath>
#include <random>

#include <fmt/format.h>

#include "service/satcs/parameter_id.hpp"
#include "service/transfer/undo.hpp"
#include "storage/care/verify.hpp"
#include "tests/service/transfer/transfer_fixture.hpp"

namespace reident::transfer::import_test {
namespace {

using satcs::parameter_id;
using storage::Archive;
using storage::Origin;
using storage::Quality;
using storage::Time;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::StartsWith;

constexpr Time second = 1'000'000'000;
constexpr Time t0 = 1'700'000'000 * second;  // 2023-11-14T22:13:20Z

class ImportTest : public ::testing::Test {
 protected:
  test::TemporaryFolder folder;
  storage::Database database{folder / "archive.db", storage::Database::Mode::read_write};
  Archive archive{database};

  ImportOptions options(const std::string& text, const std::string& name = "t.csv") {
    storage::test::write_file(folder / name, text);
    ImportOptions chosen;
    chosen.file = folder / name;
    chosen.spacecraft = "SAT-1";
    return chosen;
  }
  storage::Series held(const std::string& name, Origin origin = Origin::real) {
    const auto known = archive.parameter("SAT-1", name);
    return archive.read_with_sources("SAT-1", origin, known ? known->id : parameter_id(name),
                                     test::everything().range);
  }
  std::string error_of(const ImportOptions& chosen) {
    const auto result = test::try_import(database, chosen);
    const auto* error = std::get_if<csv::Error>(&result);
    return error ? error->message : "no error";
  }
  /// 400 rows of three parameters, one cell in ten empty.
  static std::string some_telemetry() {
    std::mt19937 random(5);
    std::string text = "unix_s,bus_u_mv,mode,i_a\n";
    for (int row = 0; row < 400; ++row) {
      text += fmt::format("{}", 1'700'000'000 + row);
      for (int column = 0; column < 3; ++column)
        text += random() % 10 == 0
                    ? ","
                    : fmt::format(",{}", static_cast<double>(random() % 1000) * 0.25);
      text += '\n';
    }
    return text;
  }
};

TEST_F(ImportTest, AColumnIsAParameterAndAnEmptyCellNoSample) {
  const auto report =
      test::import(database, options("unix_s,bus_u_mv,mode\n1700000000,28000.5,1\n1700000001,,2\n"
                                     "2023-11-14T22:13:22Z,nan,\n"));
  EXPECT_TRUE(report.complete);
  EXPECT_EQ(report.total.rows, 3U);
  EXPECT_EQ(report.total.stored, 4U);
  EXPECT_EQ(report.new_parameters, 2U);
  const auto voltage = held("bus_u");
  EXPECT_THAT(voltage.time, ElementsAre(t0, t0 + 2 * second));
  EXPECT_EQ(voltage.value[0], 28000.5);
  EXPECT_TRUE(std::isnan(voltage.value[1]));
  EXPECT_THAT(voltage.quality, ElementsAre(Quality::good, Quality::invalid));
  EXPECT_THAT(held("mode").value, ElementsAre(1, 2));
  EXPECT_EQ(archive.parameter("SAT-1", "bus_u")->unit, "mV");
  ASSERT_THAT(archive.sources(), SizeIs(1));
  EXPECT_EQ(archive.sources()[0].source, "import:t.csv");
}

TEST_F(ImportTest, ASecondImportStoresNothingAndSaysSo) {
  const ImportOptions chosen = options(some_telemetry());
  const auto first = test::import(database, chosen), second_one = test::import(database, chosen);
  EXPECT_GT(first.total.stored, 1000U);
  EXPECT_EQ(second_one.total.stored, 0U);
  EXPECT_EQ(second_one.total.duplicates, first.total.stored);
  EXPECT_EQ(second_one.resumed_at, 0U);
  EXPECT_EQ(second_one.new_parameters, 0U);
  EXPECT_EQ(archive.sample_count(), first.total.stored);
}

TEST_F(ImportTest, ALongFileSaysWhoseSamplesTheyAre) {
  ImportOptions chosen = options(
      "quality,value,time,parameter,source,origin,spacecraft,unit,remark\n"
      "good,1.5,2023-11-14T22:13:20Z,V,gs-1,real,SAT-1,V,\n"
      "suspect,2.5,1700000001000000000,V,gs-2,real,SAT-1,V,odd\n"
      "out of limits,3.5,1700000002,V,gs-1,simulated,SAT-1,V,\n"
      ",,1700000003,V,gs-1,real,SAT-1,V,no sample\n"
      "invalid,4,1700000000,17,,,SAT-2,,\n");
  chosen.spacecraft.reset();
  EXPECT_EQ(test::import(database, chosen).total.stored, 4U);
  EXPECT_THAT(held("V").value, ElementsAre(1.5, 2.5));
  EXPECT_THAT(held("V").quality, ElementsAre(Quality::good, Quality::suspect));
  EXPECT_THAT(held("V", Origin::simulated).quality, ElementsAre(Quality::out_of_limits));
  EXPECT_EQ(archive.parameter("SAT-1", "V")->unit, "V");
  EXPECT_THAT(archive.read("SAT-2", Origin::real, 17, test::everything().range).value,
              ElementsAre(4));
  EXPECT_THAT(archive.parameters("SAT-2"), IsEmpty()) << "a number is no name";
  const auto names = storage::source_names(database);
  EXPECT_EQ(names.at(held("V").source[1]), "gs-2");
  EXPECT_EQ(names.size(), 4U) << "gs-1 real and simulated, gs-2, import:t.csv";
}

TEST_F(ImportTest, EachQualityThatAnExportWritesComesBack) {
  storage::Database other(folder / "other.db", storage::Database::Mode::read_write);
  std::vector<storage::TelemetryFrame> frames;
  for (const Quality quality : storage::qualities)
    frames.push_back(storage::test::frame(frames.size(), t0 + storage::wire_value(quality) * second,
                                          {{1, quality, 1.5}}));
  Archive(other).append(frames);
  const std::string text = test::exported(other);
  ImportOptions chosen = options(text);
  chosen.spacecraft.reset();
  test::import(database, chosen);
  EXPECT_THAT(archive.read("CB4", Origin::real, 1, test::everything().range).quality,
              ::testing::ElementsAreArray(storage::qualities));
  for (const Quality quality : storage::qualities)
    EXPECT_THAT(text, HasSubstr("," + std::string(storage::name(quality)) + ",\n"));
}

TEST_F(ImportTest, TheParametersOfTheArchiveKeepTheirNumbersAndUnits) {
  archive.describe({{test::descriptor("SAT-1", 42, "bus_u", "mV")}});
  test::import(database, options("t,bus_u_mv\n1700000000,1\n"));
  EXPECT_THAT(archive.read("SAT-1", Origin::real, 42, test::everything().range).value,
              ElementsAre(1));
  EXPECT_THAT(archive.parameters("SAT-1"), SizeIs(1));
  EXPECT_THAT(error_of(options("t,bus_u_v\n1700000000,1\n")),
              HasSubstr("parameter 'bus_u' is in V here and in mV in the archive"));
}

TEST_F(ImportTest, AnImportHasNoSequenceNumbersToMiss) {
  storage::TelemetryFrame live = storage::test::frame(5000, t0, {{1, Quality::good, 1}});
  live.spacecraft = "SAT-1";
  archive.append({{live}});
  ImportOptions chosen = options("t,u\n1700000000,1\n1700000001,2\n");
  chosen.source = "station";
  test::import(database, chosen);
  live.sequence = 5001;
  live.generation_time += second;
  archive.append({{live}});
  const auto source = archive.sources().at(0);
  EXPECT_EQ(source.missing, 0U);
  EXPECT_EQ(source.restarts, 0U);
  EXPECT_EQ(source.last_sequence, 5001U);
  chosen.source = "later";
  test::import(database, chosen);
  live.source = "later";
  live.sequence = 7;
  live.generation_time += second;
  archive.append({{live}});
  EXPECT_EQ(archive.sources().at(0).missing, 0U) << "its first number is the first one that came";
  EXPECT_EQ(archive.sources().at(0).last_sequence, 7U);
}

TEST_F(ImportTest, MistakesAreNamedWithFileLineColumnAndRemedy) {
  struct Case {
    const char* text;
    const char* message;
  };
  for (const auto& [text, message] :
       {Case{"", ": the file is empty"},
        Case{"t,u\n", ": the header is not followed by a row; there is nothing to import"},
        Case{"t,u\n1700000000,1\n1700000001,on\n",
             ":3: 'on' in column 'u' is no number; mend it, say with --missing"},
        Case{"t,u\n1700000000,1\n,2\n", ":3: '' in column 't' is no time as the others"},
        Case{"t,u\n1700000000,1\n1700000001\n", ":3: the row has 1 cells, the header has 2"},
        Case{"t,u\n1700000000,1\n1700000001,\"2\n", ":3: a quoted cell that starts in this row"},
        Case{"t,u\nnoon,1\n", "no column looks like a time; name it with --time"},
        Case{"a,b\n1,2\n", "no column looks like a time; name it with --time"},
        Case{"parameter,time,value,quality\nV,1700000000,1,fine\n",
             ":2: 'fine' in column 'quality' is no quality; use good, out of limits, suspect, "
             "invalid"},
        Case{"parameter,time,value\n,1700000000,1\n", ":2: '' in column 'parameter' names no"},
        Case{"parameter,time,value\nV,1700000000,high\n", ":2: 'high' in column 'value' is no"},
        Case{"parameter,time,value,Units\nV,1700000000,1,V\nV,1700000001,1000,mV\n",
             ":3: parameter 'V' is in mV here and in V in line 2"},
        Case{"t,st\n1700000000,12\n1700000001,1C\n", "write 0x in front"},
        Case{"t,u_v,u_mv\n1700000000,1,2\n", "would both be parameter 'u'"}}) {
    const std::string error = error_of(options(text, "bad.csv"));
    EXPECT_THAT(error, StartsWith((folder / "bad.csv").string())) << text;
    EXPECT_THAT(error, HasSubstr(message)) << text;
  }
  ImportOptions nobody = options("t,u\n1700000000,1\n");
  nobody.spacecraft.reset();
  EXPECT_THAT(error_of(nobody), HasSubstr("name it with --spacecraft"));
  ImportOptions pipe = options("");
  pipe.file = "/dev/null";
  EXPECT_THAT(error_of(pipe), StartsWith("/dev/null: "));
  pipe.file = folder.path();
  EXPECT_THAT(error_of(pipe), HasSubstr("is a directory; name a CSV file in it"));
}

TEST_F(ImportTest, BadLinesAreLeftOutAndCountedWhereAskedFor) {
  ImportOptions chosen = options(
      "t,u\n1700000000\n1700000000,1\n1700000001,on\nnever,3\n1700000003,4,5\n1700000004,5\n");
  chosen.skip_bad_lines = true;
  const auto report = test::import(database, chosen);
  EXPECT_EQ(report.total.rows, 2U);
  EXPECT_EQ(report.total.bad_lines, 4U);
  ASSERT_THAT(report.first_bad_lines, SizeIs(4));
  EXPECT_THAT(report.first_bad_lines[2], HasSubstr("t.csv:5: 'never' in column 't'"));
  EXPECT_THAT(held("u").value, ElementsAre(1, 5));
}

TEST_F(ImportTest, AMendedLineIsWhereTheSameImportGoesOn) {
  EXPECT_THAT(error_of(options("t,u\n1700000000,1\n1700000001,2\n1700000002,x\n1700000003,4\n")),
              HasSubstr("the lines before it are imported, the same command goes on there"));
  EXPECT_THAT(held("u").value, ElementsAre(1, 2));
  const auto report = test::import(
      database, options("t,u\n1700000000,1\n1700000001,2\n1700000002,3\n1700000003,4\n"));
  EXPECT_EQ(report.resumed_at, 4U);
  EXPECT_EQ(report.samples, 2U);
  EXPECT_EQ(report.total.stored, 4U);
  EXPECT_THAT(held("u").value, ElementsAre(1, 2, 3, 4));
}

TEST_F(ImportTest, AFileThatChangedBeforeThatPlaceIsImportedAnew) {
  error_of(options("t,u\n1700000000,1\n1700000001,2\n1700000002,x\n"));
  const auto report =
      test::import(database, options("t,u\n1700000000,1\n1700000001,7\n1700000002,3\n"));
  EXPECT_EQ(report.resumed_at, 0U);
  EXPECT_EQ(report.total.duplicates, 1U);
  EXPECT_EQ(report.total.conflicts, 1U);
  EXPECT_EQ(report.total.stored, 1U);
}

TEST_F(ImportTest, StoppedAnywhereItGoesOnToTheSameContents) {
  const ImportOptions chosen = options(some_telemetry());
  const ImportLimits small{.samples = 50, .frames = 1000};
  test::import(database, chosen);
  const std::string all = test::exported(database);
  std::mt19937 random(9);
  for (int trial = 0; trial < 5; ++trial) {
    storage::Database other(folder / fmt::format("{}.db", trial),
                            storage::Database::Mode::read_write);
    std::uint64_t samples = 0;
    for (bool complete = false; !complete;) {
      std::uint64_t batches = random() % 6;
      const auto result = test::try_import(other, chosen, small,
                                           [&](const ImportProgress&) { return batches-- > 0; });
      const auto& report = std::get<ImportReport>(result);
      EXPECT_EQ(report.resumed_at == 0, samples == 0);
      samples += report.samples;
      complete = report.complete;
      EXPECT_EQ(report.total.samples, samples);
      EXPECT_EQ(report.total.stored, samples) << "nothing is read twice";
    }
    EXPECT_EQ(test::exported(other), all);
  }
}

TEST_F(ImportTest, WhatAFileOfOneSampleARowHasBesidesIsNamed) {
  const ImportReport report = test::import(
      database, options("Tag,Timestamp,Value,Status,quality\n"
                        "u,2024-02-28T22:00:00Z,1.5,Bad,GOOD\nv,2024-02-28T22:00:00Z,2.5,Ok,\n"));
  EXPECT_EQ(report.total.stored, 2U);
  EXPECT_THAT(report.remarks, ElementsAre(HasSubstr("'Status' is left out")));
  EXPECT_EQ(test::import(database, options("entity_id,state,last_changed\n"
                                           "a,5.8,2024-02-28T22:00:00Z\nb,27.3,"
                                           "2024-02-28T22:00:03Z\n"))
                .new_parameters,
            2U);
}

TEST_F(ImportTest, QuotesLineEndsAndAByteOrderMarkDoNotMatter) {
  ImportOptions chosen = options(
      "\xEF\xBB\xBF"
      "\"t\",\"u, main\"\r\n\"1700000000\",\"1\"\r\n\r\n1700000001,\"2\"\r\n");
  EXPECT_EQ(test::import(database, chosen).total.stored, 2U);
  EXPECT_THAT(held("u, main").value, ElementsAre(1, 2));
}

TEST_F(ImportTest, ColumnsAreChosenAndNamed) {
  ImportOptions chosen = options("time_ms,a_mv,b,note\n1700000000000,1,2,x\n");
  chosen.only = {"a_mv", "b"};
  chosen.mappings = {{"b", "V_BUS", "V"}};
  chosen.keep_names = true;
  test::import(database, chosen);
  EXPECT_THAT(held("a_mv").time, ElementsAre(t0));
  EXPECT_THAT(held("V_BUS").value, ElementsAre(2));
  EXPECT_THAT(archive.parameters("SAT-1"), SizeIs(2));
}

TEST_F(ImportTest, ColumnsAreLeftOut) {
  ImportOptions chosen = options("t,u,note\n1700000000,1,x\n");
  chosen.leave_out = {"note"};
  EXPECT_EQ(test::import(database, chosen).total.stored, 1U);
  chosen.leave_out = {"notes"};
  EXPECT_THAT(error_of(chosen), HasSubstr("there is no column 'notes'"));
  chosen.leave_out = {"note", "u"};
  EXPECT_THAT(error_of(chosen), HasSubstr("--leave-out leaves no column"));
}

TEST_F(ImportTest, AnImportIsTakenBackAndTheRestStays) {
  storage::TelemetryFrame live =
      storage::test::frame(1, t0 + second / 2, {{parameter_id("u"), Quality::good, 9}});
  live.spacecraft = "SAT-1";
  archive.append({{live}});
  const ImportOptions wrong = options("t,u,v\n1700000000,1,2\n1700000001,3,4\n", "wrong.csv");
  const ImportOptions right = options("t,u\n1700000009,5\n", "right.csv");
  test::import(database, wrong);
  test::import(database, right);
  const auto undone = undo_import(database, wrong.file);
  ASSERT_TRUE(std::holds_alternative<storage::SourceRemovalReport>(undone));
  EXPECT_EQ(std::get<storage::SourceRemovalReport>(undone).samples, 4U);
  EXPECT_THAT(held("u").value, ElementsAre(9, 5));
  EXPECT_THAT(held("v").value, IsEmpty());
  EXPECT_EQ(archive.sample_count(), 2U);
  EXPECT_EQ(
      storage::verify(database, {}, [](const storage::VerifyProgress&) { return true; }).found, 0U);
  const auto again = test::import(database, wrong);
  EXPECT_EQ(again.resumed_at, 0U);
  EXPECT_EQ(again.total.stored, 4U);
  EXPECT_THAT(held("u").value, ElementsAre(1, 9, 3, 5));
}

TEST_F(ImportTest, OnlyWhatTheLogKnowsIsTakenBack) {
  const auto refusal = [&](const ImportOptions& chosen) {
    const auto undone = undo_import(database, chosen.file);
    const auto* error = std::get_if<csv::Error>(&undone);
    return error ? error->message : "no error";
  };
  EXPECT_THAT(refusal(options("t,u\n1700000000,1\n")),
              HasSubstr("holds no import of this file; it has none"));
  const ImportOptions exported =
      options("parameter,time,value,source\nu,1700000000,1,station\n", "long.csv");
  test::import(database, exported);
  EXPECT_THAT(refusal(exported), HasSubstr("say themselves what they come from"));
  ImportOptions one = options("t,u\n1700000000,1\n", "one.csv"),
                other = options("t,u\n1700000001,1\n", "two.csv");
  one.source = other.source = "station";
  test::import(database, one);
  test::import(database, other);
  EXPECT_THAT(refusal(one), HasSubstr("have the same source 'station'"));
}

}  // namespace
}  // namespace reident::transfer::import_test
