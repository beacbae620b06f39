// Rows and cells of a file of commas with a header in its first line, whatever is in them.
#include <fstream>
#include <random>
#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/support/time_text.hpp"
#include "service/telemetry_file/telemetry_file.hpp"

namespace reident::telemetry_file::row_reader_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

ReadingOptions plain() {
  ReadingOptions options;
  options.dialect.separator = ',';
  options.cells.style = NumberStyle{};
  return options;
}

using Rows = std::vector<std::vector<std::string>>;

/// The whole of a text as cells, header first, or the message of the error that stopped it.
std::variant<Rows, std::string> all_rows(std::variant<TelemetryFile, Error> opened) {
  if (const auto* error = std::get_if<Error>(&opened)) return error->message;
  auto& reader = std::get<TelemetryFile>(opened);
  Rows rows{reader.columns()};
  while (true) {
    switch (reader.next()) {
      case TelemetryFile::Step::row:
        rows.emplace_back(reader.cells().begin(), reader.cells().end());
        break;
      case TelemetryFile::Step::end:
        return rows;
      case TelemetryFile::Step::error:
        return reader.error().message;
    }
  }
}

Rows rows_of(const std::string& text) {
  auto result = all_rows(TelemetryFile::of_text(text, "t.csv", plain()));
  if (const auto* message = std::get_if<std::string>(&result)) ADD_FAILURE() << *message;
  auto* rows = std::get_if<Rows>(&result);
  return rows ? *rows : Rows{};
}

std::string error_of(const std::string& text) {
  auto result = all_rows(TelemetryFile::of_text(text, "t.csv", plain()));
  const auto* message = std::get_if<std::string>(&result);
  return message ? *message : "no error";
}

class TelemetryRowFile : public testing::Test {
 protected:
  TelemetryRowFile() { std::filesystem::create_directories(folder_); }
  ~TelemetryRowFile() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path write(const std::string& text) {
    const auto path = folder_ / "t.csv";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  ("reident-csv-" + std::to_string(getpid()) + "-" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST(TelemetryRows, AreCutIntoCells) {
  struct Case {
    const char* text;
    Rows rows;
  };
  const std::vector<Case> cases = {
      {"a,b\n1,2\n", {{"a", "b"}, {"1", "2"}}},
      {"a,b\n1,2", {{"a", "b"}, {"1", "2"}}},
      {"a,b\r\n1,2\r\n", {{"a", "b"}, {"1", "2"}}},
      {"\xEF\xBB\xBF"
       "a,b\n1,2\n",
       {{"a", "b"}, {"1", "2"}}},
      {" a , b \n 1 , 2 \n", {{"a", "b"}, {" 1 ", " 2 "}}},
      {"a,b\n,\n", {{"a", "b"}, {"", ""}}},
      {"a,b\n\n1,2\n\r\n3,4\n\n", {{"a", "b"}, {"1", "2"}, {"3", "4"}}},
      {"\n\na,b\n1,2\n", {{"a", "b"}, {"1", "2"}}},
      {"\"a\",\"b,c\"\n\"1\",\"2\"\n", {{"a", "b,c"}, {"1", "2"}}},
      {"a,b\n\"x\"\"y\",\"\"\n", {{"a", "b"}, {"x\"y", ""}}},
      {"a,b\n\"\"\"\",\"\"\"\"\"\"\n", {{"a", "b"}, {"\"", "\"\""}}},
      {"a,b\n\"1\n2\",\"3\r\n4\"\r\n5,6\n", {{"a", "b"}, {"1\n2", "3\r\n4"}, {"5", "6"}}},
      {"a,b\n5\"\"6,7\"\n8,9\n", {{"a", "b"}, {"5\"\"6", "7\""}, {"8", "9"}}},
      {"a,b\n1, \"2,5\"\n", {{"a", "b"}, {"1", "2,5"}}},
      {"\"a\nb\",c\n1,2\n", {{"a b", "c"}, {"1", "2"}}},
      {"a\n1\n", {{"a"}, {"1"}}},
      {"a,\n1,\n", {{"a", ""}, {"1", ""}}},
      {",,\n1,2,3\n", {{"", "", ""}, {"1", "2", "3"}}},
      {"a,b\n", {{"a", "b"}}},
      {"a,b\n1,2\n\xEF\xBB\xBF"
       "a,b\n3,4\n",
       {{"a", "b"}, {"1", "2"}, {"3", "4"}}},
      {"a,b\n\"x \\\"y\\\" z\",2\n", {{"a", "b"}, {"x \"y\" z", "2"}}},
      {"a,b\n\"C:\\\",2\n", {{"a", "b"}, {"C:\\", "2"}}},
      {"a,b\n\"x\\\"\"y\",2\n", {{"a", "b"}, {"x\\\"y", "2"}}},
  };
  for (const auto& c : cases) EXPECT_EQ(rows_of(c.text), c.rows) << c.text;
}

TEST(TelemetryRowErrors, NameFileLineAndRemedy) {
  struct Case {
    const char* text;
    const char* begin;
    const char* remedy;
  };
  for (const auto& [text, begin, remedy] :
       {Case{"", "t.csv: the file is empty",
             "a header row with the names of the columns is needed"},
        Case{"\n\r\n", "t.csv: the file is empty", "header row"},
        Case{"1,2\n3,4\n", "t.csv:1: the line holds values ('1,2')", "--names"},
        Case{"a,b,a\n", "t.csv:1: two columns are called 'a'", "--names"},
        Case{"a,b\n1,2\n1\n", "t.csv:3: the row has 1 cells, the header has 2", "--skip-bad-lines"},
        Case{"a,b\n1,2\n1,2,3\n", "t.csv:3: the row has 3 cells, the header has 2", "needs quotes"},
        Case{"a,b\n\n\"1\n1\",2\n1,2,3\n", "t.csv:5: the row has 3 cells", "needs quotes"},
        Case{"a,b\n1,2\n1,\"2\n3,4\n",
             "t.csv:3: a quoted cell that starts in this row is not closed", "add the \""},
        Case{"a,b\n\"1\"x,2\n", "t.csv:2: text follows the closing quote of a cell",
             "double the quotes"}}) {
    EXPECT_THAT(error_of(text), StartsWith(begin)) << text;
    EXPECT_THAT(error_of(text), HasSubstr(remedy)) << text;
  }
}

TEST(TelemetryRows, OfACutLastLineAreLeftOutAndSaid) {
  for (const char* text : {"a,b\n1,2\n3", "a,b\n1,2\n3,\"4"}) {
    auto opened = TelemetryFile::of_text(text, "t.csv", plain());
    auto& file = std::get<TelemetryFile>(opened);
    ASSERT_EQ(file.next(), TelemetryFile::Step::row) << text;
    ASSERT_EQ(file.next(), TelemetryFile::Step::end) << text;
    EXPECT_THAT(file.remarks(), ElementsAre(HasSubstr("t.csv:3: the last line was cut")));
  }
}

TEST(TelemetryRows, OfAHeaderThatComesAgainAreSkippedAndCounted) {
  auto opened = TelemetryFile::of_text("a,b\n1,2\na,b\n3,4\na,b\n", "t.csv", plain());
  auto& file = std::get<TelemetryFile>(opened);
  for (const char* cell : {"1", "3"}) {
    ASSERT_EQ(file.next(), TelemetryFile::Step::row);
    EXPECT_EQ(file.cells()[0], cell);
  }
  EXPECT_EQ(file.next(), TelemetryFile::Step::end);
  EXPECT_THAT(file.remarks(), ElementsAre(AllOf(HasSubstr("t.csv:3: "), HasSubstr("2 in all"))));
}

TEST(TelemetryRows, BehindAHeaderWithTheColumnsInAnotherOrderAreNotRead) {
  for (const bool has_time : {true, false}) {
    auto opened = TelemetryFile::of_text("time,u,y\n1709157600,1,2\ntime,y,u\n1709157610,3,4\n",
                                         "t.csv", plain());
    auto& file = std::get<TelemetryFile>(opened);
    EXPECT_FALSE(has_time && file.find_time());
    ASSERT_EQ(file.next(), TelemetryFile::Step::row);
    ASSERT_EQ(file.next(), TelemetryFile::Step::error);
    EXPECT_EQ(file.damage(), Damage::none) << "not to be skipped";
    EXPECT_THAT(file.error().message, StartsWith("t.csv:3: another header"));
  }
}

TEST(TelemetryRows, WithBlankCellsAtTheirEndsHaveThoseOfTheHeader) {
  auto opened = TelemetryFile::of_text("time;u;y\n10;1,5;2,5;;;\n20;1,5;2,5;;;\n", "t.csv", {});
  auto& file = std::get<TelemetryFile>(opened);
  EXPECT_THAT(file.columns(), ElementsAre("time", "u", "y"));
  for (int row = 0; row < 2; ++row) ASSERT_EQ(file.next(), TelemetryFile::Step::row);
  EXPECT_EQ(file.cell(2).value, 2.5);
}

TEST(TelemetryRows, ThatAreCommentsAmongOthersAreFoundByTheirMark) {
  std::string text = "time,u,y\n";
  for (int row = 0; row < 40; ++row)
    text += "17091576" + std::to_string(10 + row) + ",1,2\n" + (row == 20 ? "# a, b, c, d\n" : "");
  auto opened = TelemetryFile::of_text(text, "t.csv", {});
  auto& file = std::get<TelemetryFile>(opened);
  for (int row = 0; row < 40; ++row) ASSERT_EQ(file.next(), TelemetryFile::Step::row) << row;
  EXPECT_EQ(file.next(), TelemetryFile::Step::end);
  EXPECT_THAT(file.found(), HasSubstr("comments begin with #"));
}

TEST_F(TelemetryRowFile, EndsBeforeTheNulBytesThatFillABlock) {
  auto opened = TelemetryFile::open(write("time,x\n1,2\n3,4\n" + std::string(512, '\0')), {});
  ASSERT_TRUE(std::holds_alternative<TelemetryFile>(opened)) << std::get<Error>(opened).message;
  auto& read = std::get<TelemetryFile>(opened);
  EXPECT_EQ(read.next(), TelemetryFile::Step::row);
  EXPECT_EQ(read.next(), TelemetryFile::Step::row);
  EXPECT_EQ(read.next(), TelemetryFile::Step::end);
  EXPECT_EQ(read.remarks().size(), 1U);
}

TEST(TelemetryRows, WithNulBytesAreBadByThemselves) {
  using namespace std::string_literals;
  auto opened = TelemetryFile::of_text("a,b\n1,2\n9,\0\0\n3,4\n"s, "t.csv", plain());
  auto& file = std::get<TelemetryFile>(opened);
  ASSERT_EQ(file.next(), TelemetryFile::Step::row);
  ASSERT_EQ(file.next(), TelemetryFile::Step::error);
  EXPECT_EQ(file.damage(), Damage::nul_bytes);
  EXPECT_THAT(file.error().message, StartsWith("t.csv:3: the row holds NUL bytes"));
  ASSERT_EQ(file.next(), TelemetryFile::Step::row);
  EXPECT_EQ(file.cells()[1], "4");
}

TEST(TelemetryRowErrors, OfAMissingColumnNameTheOnesThatExist) {
  auto opened = TelemetryFile::of_text("unix_s,bus u\n", "t.csv", plain());
  const auto found = std::get<TelemetryFile>(opened).find("bus_u");
  ASSERT_TRUE(std::holds_alternative<Error>(found));
  EXPECT_EQ(std::get<Error>(found).message,
            "t.csv: there is no column 'bus_u'; the columns are: unix_s, bus u");
  EXPECT_EQ(std::get<std::size_t>(std::get<TelemetryFile>(opened).find("bus u")), 1U);
}

/// The rows that are read up to the end, or up to an error, which follows.
std::vector<std::string> times_and_end(const std::string& text,
                                       const ReadingOptions& options = {}) {
  auto opened = TelemetryFile::of_text(text, "t.csv", options);
  auto& file = std::get<TelemetryFile>(opened);
  if (const auto error = file.find_time()) return {error->message};
  std::vector<std::string> all;
  auto step = file.next();
  for (; step == TelemetryFile::Step::row; step = file.next())
    all.push_back(time_text(file.time_ns()));
  if (step == TelemetryFile::Step::error) all.push_back(file.error().message);
  for (std::string& remark : file.remarks()) all.push_back(std::move(remark));
  return all;
}

/// Eight rows of a day.
std::string day_rows(const std::string& day) {
  std::string text;
  for (const char* hour : {"10", "11", "12", "13", "14", "15", "16", "17"})
    text += day + " " + hour + ":00:00,1,2\n";
  return text;
}

TEST(TelemetryJoinedFiles, AreRefusedWhereTheSecondIsOfAnotherClockOrder) {
  const std::string first = day_rows("2024-02-28"), second = day_rows("2024-02-29");
  struct Case {
    std::string above, between;
    int line;
  };
  for (const auto& [above, between, line] :
       {Case{"# Timezone: Europe/Berlin\ntime,u,v\n", "# Timezone: UTC\ntime,u,v\n", 11},
        Case{"time,u,v\n", "# Timezone: Asia/Tokyo\ntime,u,v\n", 10},
        Case{"Timezone,CET,\ntime,u,v\n", "Timezone,UTC,\ntime,u,v\n", 11},
        Case{"Timezone,CET\ntime,u,v\n", "Timezone,UTC\ntime,u,v\n", 11},
        Case{"# Spacecraft: SAT-1\ntime,u,v\n", "# Spacecraft: SAT-2\ntime,u,v\n", 11},
        Case{"# TIME_SYSTEM = UTC\n# time,u,v\n", "# TIME_SYSTEM = TAI\n# time,u,v\n", 11},
        Case{"time,u (A),v (V)\n", "time,u (mA),v (mV)\n", 10},
        Case{"time,u,v\n,A,V\n", "time,u,v\n,mA,mV\n", 12},
        Case{"# time,u,v\n", "# time,v,u\n", 10}, Case{"# time,u\n", "# time,v\n", 10}}) {
    std::string text = above + first + between + second;
    if (above == "# time,u\n")
      for (auto at = text.find(",2\n"); at != std::string::npos; at = text.find(",2\n"))
        text.erase(at, 2);
    const auto read = times_and_end(text);
    ASSERT_GE(read.size(), 9U) << text;
    EXPECT_THAT(read[8], StartsWith(fmt::format("t.csv:{}: ", line))) << text;
  }
  const std::string again = "# Timezone: UTC\n# Spacecraft: SAT-1\n# time,u,v\n";
  EXPECT_EQ(times_and_end(again + first + again + second).size(), 16U);
  ReadingOptions zone;
  zone.time.zone = "UTC";
  EXPECT_EQ(times_and_end("time,u,v\n" + first + "# Timezone: CET\n" + second, zone).size(), 16U)
      << "a zone that is given";
}

TEST(TelemetryRowReader, LeavesOutALastRowWhoseLastNumberIsCut) {
  struct Case {
    const char* usual;
    const char* last;
    bool is_cut;
  };
  for (const auto& [usual, last, is_cut] :
       {Case{"28.417", "28.4", true}, Case{"28.417", "2", true}, Case{"28.417", "28.418", false},
        Case{"2.5e-03", "2.5e-0", true}, Case{"2.5e-03", "2.5", true}, Case{"28041", "280", true},
        Case{"101", "99", false}, Case{"ON", "ON", false}, Case{"\"28.417\"", "\"28.4\"", false},
        Case{"28,417", "28,4", true}}) {
    const std::string separator = std::string(usual).find(',') == std::string::npos ? "," : ";";
    std::string text = "time" + separator + "u\n";
    for (int row = 0; row < 40; ++row)
      text += fmt::format("2024-02-28T22:00:{:02}Z{}{}\n", row, separator, usual);
    text += "2024-02-28T22:00:40Z" + separator + last;
    const auto cut = times_and_end(text);
    EXPECT_EQ(cut.size(), 41U) << last;
    EXPECT_THAT(cut.back(), is_cut ? HasSubstr("t.csv:42: ") : HasSubstr("22:00:40")) << last;
    EXPECT_THAT(times_and_end(text + "\n").back(), HasSubstr("22:00:40")) << last;
  }
  std::string few = "time,u\n";
  for (int row = 0; row < 9; ++row) few += fmt::format("2024-02-28T22:00:0{}Z,1.50\n", row);
  const auto kept = times_and_end(few + "2024-02-28T22:00:09Z,2");
  ASSERT_EQ(kept.size(), 11U) << "few rows leave it open";
  EXPECT_THAT(kept.back(), StartsWith("t.csv:11: "));
}

TEST(TelemetryRowReader, NamesRowsOfAnotherSpacecraft) {
  std::string text = "time,spacecraft,u\n";
  for (int row = 0; row < 40'000; ++row)
    text += fmt::format("{},{},1.5\n", 1'700'000'000 + row, row < 30'000 ? "SAT-1" : "SAT-2");
  const auto read = times_and_end(text);
  ASSERT_EQ(read.size(), 30'001U);
  EXPECT_THAT(read.back(), AllOf(StartsWith("t.csv:30002: "), HasSubstr("--force-times")));
  ReadingOptions options;
  for (const auto& [given, remarks] : {std::pair("SAT-1", 0U), {"Sat 1", 0U}, {"SAT-7", 2U}}) {
    options.spacecraft = given;
    EXPECT_EQ(times_and_end("# Satellite: SAT-1\ntime,spacecraft,u\n1700000000,SAT-1,2\n", options)
                  .size(),
              1U + remarks)
        << given;
  }
}

TEST(TelemetryRowReader, KnowsTheLineOfEachRowAndHowFarItIs) {
  auto opened = TelemetryFile::of_text("a\n\n\"x\ny\"\nz\n", "t.csv", plain());
  auto& reader = std::get<TelemetryFile>(opened);
  EXPECT_EQ(reader.size(), 11U);
  ASSERT_EQ(reader.next(), TelemetryFile::Step::row);
  EXPECT_EQ(reader.line(), 3U);
  EXPECT_EQ(reader.bytes_read(), 9U);
  ASSERT_EQ(reader.next(), TelemetryFile::Step::row);
  EXPECT_EQ(reader.line(), 5U);
  EXPECT_EQ(reader.bytes_read(), 11U);
  EXPECT_EQ(reader.next(), TelemetryFile::Step::end);
  EXPECT_EQ(reader.next(), TelemetryFile::Step::end);
}

TEST_F(TelemetryRowFile, LargerThanTheBufferIsReadAsWritten) {
  std::mt19937 random(7);
  Rows rows{{"a", "b", "c"}};
  std::string text = "a,b,c\n";
  while (text.size() < 3'000'000) {
    std::vector<std::string> row(3);
    for (auto& cell : row) cell.assign(random() % 100, static_cast<char>('d' + random() % 20));
    if (random() % 5 == 0) row[1] += ",\n\r\n\"";
    if (rows.size() == 1000) row[2].assign(900'000, 'x');  // grows the buffer
    for (std::size_t c = 0; c < 3; ++c) {
      std::string cell = row[c];
      for (auto at = cell.find('"'); at != std::string::npos; at = cell.find('"', at + 2)) {
        cell.insert(at, 1, '"');
      }
      if (c > 0) text += ',';
      if (c == 1) cell.insert(0, 1, '"').push_back('"');
      text += cell;
    }
    text += random() % 2 ? "\n" : "\r\n";
    rows.push_back(std::move(row));
  }
  const auto result = all_rows(TelemetryFile::open(write(text), plain()));
  ASSERT_TRUE(std::holds_alternative<Rows>(result)) << std::get<std::string>(result);
  EXPECT_TRUE(std::get<Rows>(result) == rows);
}

TEST_F(TelemetryRowFile, IsReadOnFromWhereARowEnded) {
  const auto path = write(
      "\xEF\xBB\xBF"
      "a,b\r\n1,2\r\n\"3\n3\",4\r\n\r\n5,6\r\n7,8");
  auto first = TelemetryFile::open(path, plain());
  auto& reader = std::get<TelemetryFile>(first);
  for (int row = 0; row < 2; ++row) ASSERT_EQ(reader.next(), TelemetryFile::Step::row);
  auto second = TelemetryFile::open(path, plain());
  auto& later = std::get<TelemetryFile>(second);
  ASSERT_EQ(later.go_on_at(reader.bytes_read(), reader.next_line()), std::nullopt);
  for (const char* cell : {"5", "7"}) {
    ASSERT_EQ(reader.next(), TelemetryFile::Step::row);
    ASSERT_EQ(later.next(), TelemetryFile::Step::row);
    EXPECT_EQ(later.cells()[0], cell);
    EXPECT_EQ(later.line(), reader.line());
    EXPECT_EQ(later.bytes_read(), reader.bytes_read());
  }
  EXPECT_EQ(later.bytes_read(), later.size());
  EXPECT_EQ(later.next(), TelemetryFile::Step::end);
}

TEST_F(TelemetryRowFile, GoesOnBehindAWrapWhereItIsTold) {
  ReadingOptions options;
  options.time.epoch_ns = parse_time("2024-01-01T00:00:00Z");
  options.clock_may_go_back = options.continues_clock = true;
  auto opened = TelemetryFile::open(write("t_s,x\n65520,1\n65530,2\n4,3\n14,4\n"), options);
  auto& file = std::get<TelemetryFile>(opened);
  ASSERT_FALSE(file.find_time());
  std::vector<std::string> times;
  std::uint64_t position = 0, line = 0;
  while (file.next() == TelemetryFile::Step::row) {
    times.push_back(time_text(file.time_ns()));
    if (times.size() != 2) continue;
    position = file.bytes_read();
    line = file.next_line();
  }
  EXPECT_EQ(times.back(), "2024-01-01T18:12:30Z");
  ASSERT_FALSE(file.go_on_at(position, line));
  ASSERT_EQ(file.next(), TelemetryFile::Step::row);
  EXPECT_EQ(time_text(file.time_ns()), times[2]);
}

TEST_F(TelemetryRowFile, GoesOnBehindARowThatAloneIsBad) {
  const auto path = write("a,b\n1\n\"2\"x,2\n3,3\n4,\"4\n5,5\n6,\"6\n7,7\n8,\"8\"\n");
  auto opened = TelemetryFile::open(path, plain());
  auto& file = std::get<TelemetryFile>(opened);
  std::vector<std::string> good;
  std::vector<std::uint64_t> bad;
  for (auto step = file.next(); step != TelemetryFile::Step::end; step = file.next()) {
    if (step == TelemetryFile::Step::row)
      good.emplace_back(file.cells()[0]);
    else
      bad.push_back(static_cast<std::uint64_t>(
          std::stoi(file.error().message.substr(path.string().size() + 1))));
    EXPECT_EQ(step == TelemetryFile::Step::error, file.damage() != Damage::none);
  }
  EXPECT_THAT(good, ElementsAre("3", "5", "7", "8"));
  EXPECT_THAT(bad, ElementsAre(2, 3, 5, 7));
}

TEST_F(TelemetryRowFile, WithARowBeyondTheBoundIsRefused) {
  const auto path = write("a,b\n\"" + std::string(std::size_t{18} << 20, 'x') + "\",1\n");
  const auto result = all_rows(TelemetryFile::open(path, plain()));
  ASSERT_TRUE(std::holds_alternative<std::string>(result));
  EXPECT_THAT(std::get<std::string>(result),
              HasSubstr("t.csv:2: the row is longer than 16 MiB; is a quoted cell not closed?"));
}

TEST_F(TelemetryRowFile, ThatCannotBeReadIsAClearError) {
  const auto message = [](const std::filesystem::path& path) {
    const auto opened = TelemetryFile::open(path, plain());
    const auto* error = std::get_if<Error>(&opened);
    return error ? error->message : std::string("no error");
  };
  EXPECT_EQ(message(folder_ / "none.csv"),
            (folder_ / "none.csv").string() + ": there is no such file; check the path");
  EXPECT_EQ(message(folder_), folder_.string() + ": is a directory; name a CSV file in it");
  EXPECT_THAT(message(write("\xCA\xB1\xBC\xE4,u\n1,2\n")),
              HasSubstr("--encoding: GB18030 (\u65F6\u95F4)"));
  const auto path = write("a\n1\n");
  std::filesystem::permissions(path, std::filesystem::perms::none);
  if (geteuid() != 0) {  // root may read everything
    EXPECT_EQ(message(path), path.string() + ": no permission to read it (chmod +r mends it)");
  }
}

}  // namespace
}  // namespace reident::telemetry_file::row_reader_test
