#include "service/support/csv.hpp"

#include <cmath>
#include <fstream>
#include <random>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace reident::csv::csv_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Rows = std::vector<std::vector<std::string>>;

/// The whole of a text as cells, header first, or the message of the error that stopped it.
std::variant<Rows, std::string> all_rows(std::variant<Reader, Error> opened) {
  if (const auto* error = std::get_if<Error>(&opened)) return error->message;
  auto& reader = std::get<Reader>(opened);
  Rows rows{reader.columns()};
  while (true) {
    switch (reader.next()) {
      case Reader::Step::row:
        rows.emplace_back(reader.cells().begin(), reader.cells().end());
        break;
      case Reader::Step::end:
        return rows;
      case Reader::Step::error:
        return reader.error().message;
    }
  }
}

Rows rows_of(const std::string& text) {
  auto result = all_rows(Reader::from_text(text, "t.csv"));
  if (const auto* message = std::get_if<std::string>(&result)) ADD_FAILURE() << *message;
  auto* rows = std::get_if<Rows>(&result);
  return rows ? *rows : Rows{};
}

std::string error_of(const std::string& text) {
  auto result = all_rows(Reader::from_text(text, "t.csv"));
  const auto* message = std::get_if<std::string>(&result);
  return message ? *message : "no error";
}

class CsvFile : public testing::Test {
 protected:
  CsvFile() { std::filesystem::create_directories(folder_); }
  ~CsvFile() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path write(const std::string& text) {
    const auto path = folder_ / "t.csv";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  ("reident-csv-" + std::to_string(getpid()) + "-" +
                                   testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST(CsvNumber, IsReadAsWritten) {
  struct Case {
    const char* cell;
    double value;
  };
  for (const auto& [cell, value] :
       {Case{"1", 1}, Case{"-1.5", -1.5}, Case{"+1.5", 1.5}, Case{" 2 \t", 2}, Case{"1e3", 1000},
        Case{"1E-3", 0.001}, Case{".5", 0.5}, Case{"5.", 5}, Case{"0", 0}, Case{"-0", -0.0},
        Case{"0.1", 0.1}, Case{"4.9e-324", 4.9e-324}}) {
    EXPECT_EQ(to_number(cell), value) << "'" << cell << "'";
  }
}

TEST(CsvNumber, IsMissingWhereThereIsNoFiniteNumber) {
  for (const char* cell : {"", " ", "nan", "NaN", "inf", "-inf", "infinity", "n/a", "1,5", "1 2",
                           "1x", "+", "-", "+-1", "++1", "0x10", "1e999", "--", "\x01"}) {
    EXPECT_EQ(to_number(cell), std::nullopt) << "'" << cell << "'";
  }
}

TEST(CsvRows, AreCutIntoCells) {
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
      {"a\n1\n", {{"a"}, {"1"}}},
      {"a,\n1,\n", {{"a", ""}, {"1", ""}}},
      {",,\n1,2,3\n", {{"", "", ""}, {"1", "2", "3"}}},
      {"a,b\n", {{"a", "b"}}},
  };
  for (const auto& c : cases) EXPECT_EQ(rows_of(c.text), c.rows) << c.text;
}

TEST(CsvErrors, NameFileLineAndRemedy) {
  struct Case {
    const char* text;
    const char* message;
  };
  for (const auto& [text, message] : {
           Case{"",
                "t.csv: the file is empty; a header row with the names of the columns is "
                "needed"},
           Case{"\n\r\n",
                "t.csv: the file is empty; a header row with the names of the columns is "
                "needed"},
           Case{"1,2\n3,4\n",
                "t.csv:1: the first row holds numbers; put a header row with the "
                "names of the columns first"},
           Case{"a,b,a\n", "t.csv:1: two columns are called 'a'; give each column its own name"},
           Case{"a,b\n1,2\n1\n",
                "t.csv:3: the row has 1 cells, the header has 2; mend the row (a "
                "cell with a comma needs quotes)"},
           Case{"a,b\n\n\"1\n1\",2\n1,2,3\n",
                "t.csv:5: the row has 3 cells, the header has 2; mend the row (a cell with a comma "
                "needs quotes)"},
           Case{"a,b\n1,2\n1,\"2\n3,4\n",
                "t.csv:3: a quoted cell that starts in this row is not "
                "closed; add the \""},
           Case{"a,b\n\"1\"x,2\n",
                "t.csv:2: text follows the closing quote of a cell; double the "
                "quotes inside cells"},
           Case{"\xFF\xFE"
                "a",
                "t.csv: the text is UTF-16; save it as UTF-8 (iconv -f UTF-16 -t "
                "UTF-8)"},
           Case{"\x1F\x8B\b",
                "t.csv: the file is packed or no text; unpack it, or convert it to text, first"},
       }) {
    EXPECT_EQ(error_of(text), message) << text;
  }
}

TEST(CsvErrors, OfAMissingColumnNameTheOnesThatExist) {
  auto opened = Reader::from_text("unix_s,bus u\n", "t.csv");
  const auto found = std::get<Reader>(opened).find("bus_u");
  ASSERT_TRUE(std::holds_alternative<Error>(found));
  EXPECT_EQ(std::get<Error>(found).message,
            "t.csv: there is no column 'bus_u'; the columns are: unix_s, bus u");
  EXPECT_EQ(std::get<std::size_t>(std::get<Reader>(opened).find("bus u")), 1U);
}

TEST(CsvReader, KnowsTheLineOfEachRowAndHowFarItIs) {
  auto opened = Reader::from_text("a\n\n\"x\ny\"\nz\n", "t.csv");
  auto& reader = std::get<Reader>(opened);
  EXPECT_EQ(reader.size(), 11U);
  ASSERT_EQ(reader.next(), Reader::Step::row);
  EXPECT_EQ(reader.line(), 3U);
  EXPECT_EQ(reader.bytes_read(), 9U);
  ASSERT_EQ(reader.next(), Reader::Step::row);
  EXPECT_EQ(reader.line(), 5U);
  EXPECT_EQ(reader.bytes_read(), 11U);
  EXPECT_EQ(reader.next(), Reader::Step::end);
  EXPECT_EQ(reader.next(), Reader::Step::end);
}

TEST_F(CsvFile, LargerThanTheBufferIsReadAsWritten) {
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
  const auto result = all_rows(Reader::open(write(text)));
  ASSERT_TRUE(std::holds_alternative<Rows>(result)) << std::get<std::string>(result);
  EXPECT_TRUE(std::get<Rows>(result) == rows);
}

TEST_F(CsvFile, IsReadOnFromWhereARowEnded) {
  const auto path = write(
      "\xEF\xBB\xBF"
      "a,b\r\n1,2\r\n\"3\n3\",4\r\n\r\n5,6\r\n7,8");
  auto first = Reader::open(path);
  auto& reader = std::get<Reader>(first);
  for (int row = 0; row < 2; ++row) ASSERT_EQ(reader.next(), Reader::Step::row);
  auto second = Reader::open(path);
  auto& later = std::get<Reader>(second);
  ASSERT_EQ(later.go_on_at(reader.bytes_read(), reader.next_line()), std::nullopt);
  for (const char* cell : {"5", "7"}) {
    ASSERT_EQ(reader.next(), Reader::Step::row);
    ASSERT_EQ(later.next(), Reader::Step::row);
    EXPECT_EQ(later.cells()[0], cell);
    EXPECT_EQ(later.line(), reader.line());
    EXPECT_EQ(later.bytes_read(), reader.bytes_read());
  }
  EXPECT_EQ(later.bytes_read(), later.size());
  EXPECT_EQ(later.next(), Reader::Step::end);
}

TEST_F(CsvFile, GoesOnBehindARowThatAloneIsBad) {
  const auto path = write("a,b\n1\n\"2\"x,2\n3,3\n4,\"4\n5,5\n");
  auto opened = Reader::open(path);
  auto& reader = std::get<Reader>(opened);
  for (const int line : {2, 3}) {
    ASSERT_EQ(reader.next(), Reader::Step::error);
    EXPECT_TRUE(reader.only_row_is_bad());
    EXPECT_THAT(reader.error().message, HasSubstr("t.csv:" + std::to_string(line) + ": "));
  }
  ASSERT_EQ(reader.next(), Reader::Step::row);
  EXPECT_EQ(reader.cells()[0], "3");
  ASSERT_EQ(reader.next(), Reader::Step::error);
  EXPECT_FALSE(reader.only_row_is_bad()) << "nobody knows where a row with an open quote ends";
}

TEST_F(CsvFile, WithARowBeyondTheBoundIsRefused) {
  const auto path = write("a,b\n\"" + std::string(std::size_t{18} << 20, 'x') + "\",1\n");
  const auto result = all_rows(Reader::open(path));
  ASSERT_TRUE(std::holds_alternative<std::string>(result));
  EXPECT_THAT(std::get<std::string>(result),
              HasSubstr("t.csv:2: the row is longer than 16 MiB; is a quoted cell not closed?"));
}

TEST_F(CsvFile, ThatCannotBeReadIsAClearError) {
  const auto message = [](const std::filesystem::path& path) {
    const auto opened = Reader::open(path);
    const auto* error = std::get_if<Error>(&opened);
    return error ? error->message : std::string("no error");
  };
  EXPECT_EQ(message(folder_ / "none.csv"),
            (folder_ / "none.csv").string() + ": there is no such file; check the path");
  EXPECT_EQ(message(folder_), folder_.string() + ": is a directory; name a CSV file in it");
  const auto path = write("a\n1\n");
  std::filesystem::permissions(path, std::filesystem::perms::none);
  if (geteuid() != 0) {  // root may read everything
    EXPECT_EQ(message(path), path.string() + ": no permission to read it (chmod +r mends it)");
  }
}

TEST_F(CsvFile, GivesATableOfTheColumnsAskedFor) {
  const auto path = write("t,x,mode,y\n2023/3/2 00:00,1,CHRG,4\n1677715200.5,,DIS,nan\n");
  const std::vector<std::string> columns{"y", "x"};
  const auto result = read_table(path, columns, "t");
  ASSERT_TRUE(std::holds_alternative<Table>(result)) << std::get<Error>(result).message;
  const auto& table = std::get<Table>(result);
  EXPECT_EQ(table.rows, 2U);
  EXPECT_THAT(table.time_ns, ElementsAre(1'677'715'200'000'000'000, 1'677'715'200'500'000'000));
  ASSERT_EQ(table.values.size(), 2U);
  EXPECT_EQ(table.values[0][0], 4);
  EXPECT_TRUE(std::isnan(table.values[0][1]));
  EXPECT_EQ(table.values[1][0], 1);
  EXPECT_TRUE(std::isnan(table.values[1][1]));
}

TEST_F(CsvFile, WithATimeThatCannotBeReadGivesNoTable) {
  const auto path = write("t,x\n1,1\nnoon,2\n");
  const std::vector<std::string> columns{"x"};
  auto result = read_table(path, columns, "t");
  ASSERT_TRUE(std::holds_alternative<Error>(result));
  EXPECT_EQ(std::get<Error>(result).message,
            path.string() +
                ":3: 'noon' in column 't' is no time; use seconds since 1970-01-01 UTC "
                "or 2023-04-29T16:22:37Z");
  result = read_table(path, columns, "when");
  EXPECT_THAT(std::get<Error>(result).message, HasSubstr("the columns are: t, x"));
}

}  // namespace
}  // namespace reident::csv::csv_test
