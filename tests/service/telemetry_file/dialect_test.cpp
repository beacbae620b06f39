// What is found of files as people have them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/telemetry_file/long_layout.hpp"

namespace reident::telemetry_file::dialect_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// A file of these lines: `above`, then eight rows of a time, u and v.
std::string file_of(const std::string& above, const std::string& separator, bool decimal_commas) {
  std::string text = above;
  for (int row = 0; row < 8; ++row) {
    std::string numbers =
        separator + "6.00" + std::to_string(row) + separator + "28.01" + std::to_string(row);
    if (decimal_commas)
      for (char& c : numbers)
        if (c == '.') c = ',';
    text += "2024-02-28T22:00:" + std::to_string(row) + "0Z" + numbers + "\n";
  }
  // Only six rows have a second below 60.
  return text.substr(0, text.find("2024-02-28T22:00:60Z"));
}

struct Found {
  const char* above;
  const char* separator;
  bool decimal_commas;
  std::uint64_t header, units, first;
};

std::variant<Dialect, Error> dialect_of(const std::string& text, const DialectOptions& options) {
  RowReader rows(TextSource::of_text(text, "t.csv"));
  const auto head = rows.head(1 << 20);
  return find_dialect(std::get<RowReader::Head>(head), options, "t.csv");
}

TEST(TelemetryDialect, TakesTheLineOfUnitsThatIsGiven) {
  const std::string text = file_of("time,u,v\nA,V,s\ns,load units,bus units\n", ",", false);
  DialectOptions options;
  options.units_line = 3;
  const auto third = std::get<Dialect>(dialect_of(text, options));
  EXPECT_THAT(third.units, ElementsAre("s", "load units", "bus units"));
  EXPECT_EQ(third.units_line, 3U);
  EXPECT_EQ(third.first_line, 4U);
  options.units_line = 0;
  const auto none = std::get<Dialect>(dialect_of(text, options));
  EXPECT_THAT(none.units, ElementsAre());
  EXPECT_EQ(none.first_line, 4U);
  for (const std::uint64_t wrong : {1U, 1000U}) {
    options.units_line = wrong;
    EXPECT_THAT(std::get<Error>(dialect_of(text, options)).message,
                HasSubstr("--units " + std::to_string(wrong)));
  }
}

TEST(TelemetryDialect, TakesTheLineEndThatIsGiven) {
  const std::string text = "time,u\r2024-02-28T22:00:00Z,1\r2024-02-28T22:00:10Z,2\r\n";
  DialectOptions options;
  options.line_end = '\r';
  EXPECT_EQ(std::get<Dialect>(dialect_of(text, options)).layout.line_end, '\r');
  EXPECT_EQ(std::get<Dialect>(dialect_of(text, options)).first_line, 2U);
  options.line_end = '\n';
  EXPECT_EQ(
      std::get<Dialect>(dialect_of("time,u\n2024-02-28T22:00:00Z,1\n", options)).layout.line_end,
      '\n');
}

TEST(TelemetryDialect, IsFoundFromTheFirstRows) {
  for (const Found& c : {
           Found{"time,u,v\n", ",", false, 1, 0, 2},
           Found{"time;u;v\n", ";", true, 1, 0, 2},
           Found{"time\tu\tv\n", "\t", false, 1, 0, 2},
           Found{"time|u|v\n", "|", true, 1, 0, 2},
           Found{"time u v\n", "  ", false, 1, 0, 2},
           Found{"sep=;\ntime;u;v\n", ";", true, 2, 0, 3},
           Found{"# a dump\n# columns: UTC, A, V\ntime,u,v\n", ",", false, 3, 0, 4},
           Found{"# time,u,v\n", ",", false, 1, 0, 2},
           Found{"Station: KRN\nPass: 17, good\n\ntime,u,v\nUTC,A,V\n", ",", false, 4, 5, 6},
           Found{"time,u,v\n,[A],[V]\n", ",", false, 1, 2, 3},
           Found{"Zeit;u;v\nMEZ;A;V\n", ";", true, 1, 2, 3},
           Found{"time,u,v\nyyyy-mm-dd HH:MM:SS,A,V\n", ",", false, 1, 2, 3},
           Found{"time,u,v\nTime of the sample,Load current,Bus voltage\n", ",", false, 1, 0, 3},
           Found{"Satellite,SAT-1,\nStart,2024-02-28,\ntime,u,v\n", ",", false, 3, 0, 4},
           Found{"time  u     v\n----- ----- -----\n", " ", false, 1, 0, 3},
           Found{"time,17,18\n", ",", false, 1, 0, 2},
           Found{"Time of it,Load current,Bus voltage\ntime,u,v\n", ",", false, 2, 0, 3},
           Found{"# time u v\n# s A V\n", " ", false, 1, 2, 3},
           Found{"x-axis,1,2\nsecond,Ampere,Volt\n", ",", false, 1, 2, 3},
           Found{"TOA5,KRN\ntime,u,v\nTS,A,V\n,Avg,Avg\n", ",", false, 2, 0, 5},
           Found{"\"#\",\"u, A\",\"v, V\"\n", ",", false, 1, 0, 2},
           Found{"Time,Load current,Bus\ns,A,V\nComments,,filtered\n", ",", false, 1, 2, 4},
           Found{"Name:,eps,\nStart:,2/28/2024,\nScan,101 <I> (ADC),102 <V> (VDC)\n", ",", false, 3,
                 0, 4},
           Found{"\"(PDH-CSV 4.0) (GMT)(0)\",u,v\n", ",", false, 1, 0, 2},
           Found{"Number,CH1,CH2\nNO.,V,V\n", ",", false, 1, 0, 3},
           Found{"***End_of_Header***\t\t\nX_Value\tu\tv\tComment\n", "\t", false, 2, 0, 3},
       }) {
    RowReader rows(TextSource::of_text(file_of(c.above, c.separator, c.decimal_commas), "t.csv"));
    const auto head = rows.head(1 << 20);
    const auto found = find_dialect(std::get<RowReader::Head>(head), {}, "t.csv");
    ASSERT_TRUE(std::holds_alternative<Dialect>(found))
        << c.above << std::get<Error>(found).message;
    const auto& dialect = std::get<Dialect>(found);
    EXPECT_EQ(dialect.layout.separator, c.separator[0]) << c.above;
    EXPECT_EQ(dialect.header_line, c.header) << c.above;
    EXPECT_EQ(dialect.units_line, c.units) << c.above;
    EXPECT_EQ(dialect.first_line, c.first) << c.above;
    EXPECT_EQ(dialect.columns.size(), 3U) << c.above;
  }
}

TEST(TelemetryDialect, GivesTheSameValuesInEach) {
  for (const auto& [above, separator, commas] : {std::tuple("time,u,v\n", ",", false),
                                                 {"time;u;v\n", ";", true},
                                                 {"time u v\n", " ", false}}) {
    auto opened = TelemetryFile::of_text(file_of(above, separator, commas), "t.csv", {});
    auto& file = std::get<TelemetryFile>(opened);
    ASSERT_FALSE(file.find_time());
    ASSERT_EQ(file.next(), TelemetryFile::Step::row);
    EXPECT_EQ(time_text(file.time_ns()), "2024-02-28T22:00:00Z");
    EXPECT_EQ(file.cell(1).value, 6.000);
    EXPECT_EQ(file.cell(2).value, 28.010);
  }
}

TEST(TelemetryDialect, OfDatesWithABlankAndWordsIsThatOfTheOtherCells) {
  for (const char* row : {"2024-02-28 22:00:00,ON,1.5", "2024-02-28 22:00:00,ON,A,B,C,1.5",
                          "2024-02-28 22:00:00,Europe/Berlin,x"}) {
    const std::string cells(row);
    const auto commas = std::count(cells.begin(), cells.end(), ',');
    std::string text = "time";
    for (long c = 0; c < commas; ++c) text += ",p" + std::to_string(c);
    const auto found = std::get<Dialect>(dialect_of(text + "\n" + cells + "\n" + cells + "\n", {}));
    EXPECT_EQ(found.layout.separator, ',') << row;
  }
  const auto blanks = std::get<Dialect>(
      dialect_of("time u v\n10 6,001 28,011\n20 6,002 28,012\n30 6,003 28,013\n", {}));
  EXPECT_EQ(blanks.layout.separator, ' ');
}

TEST(TelemetryDialect, IsTakenAsGiven) {
  ReadingOptions options;
  options.dialect.separator = ';';
  options.dialect.header_line = 2;
  auto opened = TelemetryFile::of_text("x;y\na;b\n1,5;2\n", "t.csv", options);
  EXPECT_THAT(std::get<TelemetryFile>(opened).columns(), ElementsAre("a", "b"));
  options = {};
  options.dialect.names = {"time", "u"};
  opened = TelemetryFile::of_text("2024-02-28,1\n2024-02-29,2\n", "t.csv", options);
  EXPECT_THAT(std::get<TelemetryFile>(opened).columns(), ElementsAre("time", "u"));
  opened = TelemetryFile::of_text(
      "VERS = 2.0\nSYSTEM = UTC\nSTOP\n\n2024-02-27 1.4\n2024-02-28 1.5\n2024-02-29 1.6\n", "t",
      options);
  auto& file = std::get<TelemetryFile>(opened);
  EXPECT_THAT(file.columns(), ElementsAre("time", "u"));
  ASSERT_EQ(file.next(), TelemetryFile::Step::row) << file.error().message;
}

TEST(TelemetryDialect, OfLinesThatAreNoCellsIsRefusedWithTheRemedy) {
  for (const auto& [text, remedy] :
       {std::pair("time^u\n2024-02-28^1.5\n2024-02-29^1.6\n", "t.csv:1: no comma"),
        {"\"t\"x,u\n\"1\"x,2\n", "t.csv:1: no line can be cut into cells"},
        {"\"time,u\"\n\"2024-02-28,1.5\"\n\"2024-02-29,1.6\"\n",
         "t.csv:1: the line is one quoted cell"},
        {"{\"time\":1,\"u\":2}\n{\"time\":2,\"u\":3}\n", "t.csv:1: the text is HTML"},
        {"INSERT INTO tm VALUES (1,2);\nINSERT INTO tm VALUES (3,4);\n",
         "t.csv:1: the text is SQL"},
        {"2024-02-28 u=1 v=2\n2024-02-29 u=3 v=4\n2024-03-01 u=5 v=6\n",
         "t.csv:1: the line holds pairs"},
        {"eps,sat=1 u=1,v=2 17\neps,sat=1 u=3,v=4 18\neps,sat=1 u=5,v=6 19\n",
         "t.csv:1: the line holds pairs"},
        {"time,u,v\n2024-02-28,1,5,2,5\n2024-02-29,1,6,2,6\n",
         "t.csv:1: the line has 3 names, the rows have 5 cells"}}) {
    const auto opened = TelemetryFile::of_text(text, "t.csv", {});
    ASSERT_TRUE(std::holds_alternative<Error>(opened)) << text;
    EXPECT_THAT(std::get<Error>(opened).message, HasSubstr(remedy));
  }
}

/// Rows of a file in columns of fixed width; in the odd ones u is blank.
std::string fixed_width(int rows, const char* time_format) {
  std::string text = fmt::format("{:<22}{:>9}{:>9}\n", "TIME", "U", "V");
  for (int row = 0; row < rows; ++row)
    text += fmt::format("{:<22}{:>9}{:>9.3f}\n", fmt::format(fmt::runtime(time_format), row),
                        row % 2 == 1 ? "" : fmt::format("{}.5", row), 28.0 + row);
  return text;
}

TEST(TelemetryDialect, OfFixedWidthKeepsBlankCellsInTheirColumns) {
  for (const char* format : {"2024-02-28T22:00:{:02}Z", "2024-02-28 22:00:{:02}"}) {
    auto opened = TelemetryFile::of_text(fixed_width(40, format), "t.txt", {});
    ASSERT_TRUE(std::holds_alternative<TelemetryFile>(opened)) << std::get<Error>(opened).message;
    auto& file = std::get<TelemetryFile>(opened);
    ASSERT_FALSE(file.find_time());
    EXPECT_THAT(file.columns(), ElementsAre("TIME", "U", "V"));
    for (int row = 0; row < 40; ++row) {
      ASSERT_EQ(file.next(), TelemetryFile::Step::row) << file.error().message;
      EXPECT_EQ(time_text(file.time_ns()), fmt::format("2024-02-28T22:00:{:02}Z", row));
      EXPECT_EQ(file.cell(1).kind, row % 2 == 1 ? Cell::Kind::blank : Cell::Kind::number);
      EXPECT_EQ(file.cell(2).value, 28.0 + row);
    }
    EXPECT_EQ(file.next(), TelemetryFile::Step::end);
  }
}

TEST(TelemetryDialect, OfNamesAndCellsWithSingleBlanksIsCutAtWideOnes) {
  std::string text =
      "28 Feb 2024 23:10:00\n\n    Time (UTCG)             I Load (A)    V_Bus (V)\n"
      "------------------------    ----------    ---------\n";
  for (int row = 0; row < 8; ++row)
    text +=
        fmt::format("28 Feb 2024 22:00:0{}.000      {:10.6f}    {:9.6f}\n", row, 6.5 + row, 28.0);
  auto opened = TelemetryFile::of_text(text, "t.txt", {});
  ASSERT_TRUE(std::holds_alternative<TelemetryFile>(opened)) << std::get<Error>(opened).message;
  auto& file = std::get<TelemetryFile>(opened);
  ASSERT_FALSE(file.find_time());
  EXPECT_THAT(file.columns(), ElementsAre("Time (UTCG)", "I Load (A)", "V_Bus (V)"));
  ASSERT_EQ(file.next(), TelemetryFile::Step::row);
  EXPECT_EQ(time_text(file.time_ns()), "2024-02-28T22:00:00Z");
  EXPECT_EQ(file.cell(1).value, 6.5);
}

TEST(TelemetryDialect, OfWhatDatabasesPrintLeavesOutRulesAndTheFooter) {
  for (const auto& [rule, bar, footer, remarks] :
       {std::tuple("+----+----+\n", "|", "", 0U), {"", "", "(3 rows)\n\n", 1U}}) {
    std::string text = fmt::format("{0}{1}time|u{1}\n{0}", rule, bar);
    if (*rule == '\0') text += "--------+----\n";
    for (const char* row : {"2024-02-28|1", "2024-02-29|2", "2024-03-01|3"})
      text += fmt::format("{0}{1}{0}\n", bar, row);
    text += rule;
    auto opened = TelemetryFile::of_text(text + footer, "t.txt", {});
    ASSERT_TRUE(std::holds_alternative<TelemetryFile>(opened)) << std::get<Error>(opened).message;
    auto& file = std::get<TelemetryFile>(opened);
    for (int row = 0; row < 3; ++row)
      ASSERT_EQ(file.next(), TelemetryFile::Step::row) << file.error().message;
    EXPECT_EQ(file.next(), TelemetryFile::Step::end) << file.error().message;
    EXPECT_EQ(file.remarks().size(), remarks) << text;
  }
}

TEST(TelemetryDialect, OfWhatDatabasesPrintInColumnsKeepsBlankCells) {
  const std::string text =
      "time                 u    v\n"
      "-------------------  ---  ---\n"
      "2024-02-28 22:00:00  6.1  28.1\n"
      "2024-02-28 22:00:10  6.2      \n"
      "2024-02-28 22:00:20       28.3\n"
      "2024-02-28 22:00:30  6.4  28.4\n";
  auto file = std::get<TelemetryFile>(TelemetryFile::of_text(text, "t.txt", {}));
  std::vector<std::string> second;
  while (file.next() == TelemetryFile::Step::row) second.emplace_back(trimmed(file.cells()[1]));
  EXPECT_THAT(second, ElementsAre("6.1", "6.2", "", "6.4"));
}

TEST(TelemetryDialect, HasItsHeaderBelowMetadataAndTitlesThatLookLikeRows) {
  std::string text = "Writer\t2\n";
  for (const char* name : {"Samples", "X0", "Delta_X", "Gain", "Offset", "Rate", "Range"})
    text += std::string(name) + "\t20\t20\t\n";
  text += "***End_of_Header***\t\t\t\nX_Value\tu\tv\tComment\n";
  for (int row = 0; row < 8; ++row) text += fmt::format("0.{}\t1.{}\t2.{}\t\n", row, row, row);
  const auto dialect = std::get<Dialect>(dialect_of(text, {}));
  EXPECT_THAT(dialect.columns, ElementsAre("X_Value", "u", "v", "Comment"));
  EXPECT_EQ(dialect.first_line, 11U);
}

TEST(TelemetryDialect, KeepsItsHeaderAboveARowWithoutAnyValue) {
  for (const std::string nothing : {",", "NaN,NaN", "NA,", " , null"}) {
    const auto dialect = std::get<Dialect>(
        dialect_of("u,v\n0.1,1.5\n0.2,1\n" + nothing + "\n0.3,1.7\n0.2,1\n0.5,1.5\n", {}));
    EXPECT_THAT(dialect.columns, ElementsAre("u", "v")) << nothing;
  }
}

TEST(TelemetryDialect, JoinsADateAndAClockWithACommaBetweenThem) {
  const std::string text = "time,u\n28.2.2024, 22:00:00,6.1\n28.2.2024, 22:00:10,6.2\n";
  auto file = std::get<TelemetryFile>(TelemetryFile::of_text(text, "t.csv", {}));
  ASSERT_EQ(file.next(), TelemetryFile::Step::row);
  EXPECT_THAT(file.cells(), ElementsAre("28.2.2024, 22:00:00", "6.1"));
}

TEST(TelemetryDialect, LeavesNumbersOfRowsWithoutAName) {
  auto opened = TelemetryFile::of_text(
      "\"time\" \"u\"\n\"1\" \"2024-02-28T22:00:00Z\" 1.5\n\"2\" \"2024-02-28T22:00:10Z\" 1.6\n",
      "t.txt", {});
  ASSERT_TRUE(std::holds_alternative<TelemetryFile>(opened)) << std::get<Error>(opened).message;
  auto& file = std::get<TelemetryFile>(opened);
  EXPECT_THAT(file.columns(), ElementsAre("", "time", "u"));
  EXPECT_EQ(file.unnamed_columns().size(), 1U);
}

TEST(TelemetryDialect, SaysWhatMayBeReadOtherwise) {
  const auto remarks = [](const std::string& text) {
    auto opened = TelemetryFile::of_text(text, "t.csv", {});
    auto& file = std::get<TelemetryFile>(opened);
    EXPECT_FALSE(file.find_time());
    return file.remarks();
  };
  const std::string rows = "2024-02-28T22:00:00Z,1,2024-02-28T22:00:03Z,2\n";
  EXPECT_THAT(remarks("t,u,received,v\n" + rows),
              ElementsAre(HasSubstr("other times in received")));
  EXPECT_THAT(remarks("t,u,v\n2024-02-28T22:00:00Z,1,2\n"), ElementsAre());
}

TEST(TelemetryDialect, EndsLinesWithAnyNumberOfCarriageReturns) {
  auto opened = TelemetryFile::of_text(
      "time,u\r\r\n2024-02-28T22:00:00Z,1.5\r\r\n2024-02-28T22:00:10Z,1.6\r\r\n", "t.csv", {});
  auto& file = std::get<TelemetryFile>(opened);
  EXPECT_THAT(file.columns(), ElementsAre("time", "u"));
  ASSERT_EQ(file.next(), TelemetryFile::Step::row);
  EXPECT_EQ(file.cell(1).value, 1.5);
}

TEST(TelemetryDialect, OfOneSampleARowIsKnownByTheNamesAndWords) {
  const auto layout = [](const std::string& text) {
    auto opened = TelemetryFile::of_text(text, "t.csv", {});
    return find_long_layout(std::get<TelemetryFile>(opened)).has_value();
  };
  EXPECT_TRUE(layout("time,parameter,value\n2024-02-28,u,1\n"));
  EXPECT_TRUE(layout("Zeit;Parameter;Wert\n28.02.2024;u;1,5\n"));
  EXPECT_TRUE(layout("Parameter;Sample Time;Raw;Eng\nu;2024-02-28;15;1.5\n"));
  EXPECT_TRUE(layout("VarName;TimeString;VarValue\nu;28.02.2024;1,5\n"));
  EXPECT_TRUE(layout("_time,_value,_field,_measurement\n2024-02-28,1,u,eps\n"));
  EXPECT_FALSE(layout("time,signal,value\n2024-02-28,1.5,2.5\n")) << "two quantities";
  EXPECT_FALSE(layout("time,u,v\n2024-02-28,1.5,2.5\n"));
}

TEST(TelemetryUnits, OfOneParameterAreOne) {
  UnitsOfParameters units;
  EXPECT_FALSE(units.check("u", "V", 2));
  EXPECT_FALSE(units.check("i", "A", 3));
  EXPECT_FALSE(units.check("u", "", 4)) << "a blank unit says nothing";
  EXPECT_FALSE(units.check("u", "V", 5));
  EXPECT_THAT(units.check("u", "mV", 6).value(), AllOf(HasSubstr("mV"), HasSubstr("V in line 2")));
  EXPECT_FALSE(units.check("u", "V", 7));
  const auto layout = find_long_layout({"Zeit", "Parameter", "Wert", "Einheit"});
  EXPECT_EQ(layout.value().unit, 3U);
}

struct Style {
  std::vector<std::string_view> cells;
  char separator;
  const char* expected;  // decimal mark and thousands, or a part of the question
};

TEST(TelemetryNumbers, HaveTheStyleThatTheyShow) {
  for (const Style& c : {
           Style{{"1.5", "2"}, ',', ". "},
           Style{{"6.007", "1.724"}, ',', ". "},
           Style{{"1,5", "2,25"}, ';', ", "},
           Style{{"6,007", "1,724"}, ';', ", "},
           Style{{"1,501.8", "998.2"}, ',', ".,"},
           Style{{"1.501,8", "998,2"}, ';', ",."},
           Style{{"1 501,8", "998,2"}, ';', ",_"},
           Style{{"1'501.8", "998.2"}, ',', ".'"},
           Style{{"1\u2019501.8", "998.2"}, ',', ".'"},
           Style{{"1,234,567", "1,234"}, ',', ".,"},
           Style{{"0,125", "6,007"}, ',', ", "},
           Style{{"1,501", "998", "0", "2,007", "12"}, ',', ".,"},
           Style{{"28. Februar 2024", "6,007", "1,724"}, ';', ", "},
           Style{{"1,501", "1,502"}, ',', "--thousands"},
           Style{{"1,501", "1,502", "1,503", "1,504", "1,505"}, ',', "--thousands"},
           Style{{"1,5", "1.25"}, ';', "--decimal"},
           Style{{"1,100", "28.417"}, ';', "--decimal"},
           Style{{"28.02.2024 22:00", "6.000", "6.052", "6.101"}, ';', "--thousands"},
           Style{{"998", "12", "1.501", "1.502", "1.503"}, ',', "--thousands"},
           Style{{"-999", "28.006", "27.828", "-999", "27.709"}, ',', ". "},
           Style{{"28.02.2024 22:00", "0.998", "6.052", "6.101"}, ';', ". "},
           Style{{"1,100", "28.417"}, ',', ".,"},
       }) {
    const std::vector<std::vector<std::string_view>> columns = {c.cells};
    const auto found = find_style(columns, c.separator);
    if (const auto* style = std::get_if<NumberStyle>(&found)) {
      const std::string marks = {style->decimal, style->thousands == '\0'  ? ' '
                                                 : style->thousands == ' ' ? '_'
                                                                           : style->thousands};
      EXPECT_EQ(marks, c.expected) << c.cells[0];
    } else {
      EXPECT_THAT(std::get<StyleQuestion>(found).text, HasSubstr(c.expected)) << c.cells[0];
    }
  }
}

TEST(TelemetryCells, HaveDecimalCommasWhereAllOfManyInSeveralColumnsHaveThreeDigitsBehindThem) {
  const std::vector<std::string_view> one(30, "6,007"), other(30, "28,006"), counts(30, "998");
  using Columns = std::vector<std::vector<std::string_view>>;
  EXPECT_EQ(std::get<NumberStyle>(find_style(Columns{one, other}, ',')).decimal, ',');
  for (const Columns& columns : {Columns{one}, Columns{one, other, counts}})
    EXPECT_TRUE(std::holds_alternative<StyleQuestion>(find_style(columns, ',')));
}

CellFormat format_of(const std::vector<std::string_view>& cells) {
  return find_format(cells, "x", {}, {});
}

TEST(TelemetryCells, ThatAnInstrumentCouldNotMeasureAreNoValues) {
  for (const char* cell : {"9.91E+37", "+9.90000000E+37", "-9.9e37"}) {
    const CellFormat format = format_of({"1.5", "2.5", cell});
    EXPECT_EQ(read_cell(cell, format).kind, Cell::Kind::missing) << cell;
    EXPECT_EQ(format.no_value, cell);
    EXPECT_EQ(read_cell(cell, format_of({"1.5"})).kind, Cell::Kind::missing) << "behind the head";
    EXPECT_EQ(read_cell(cell, format_of({"1.5 V"})).kind, Cell::Kind::missing) << "beside units";
  }
  EXPECT_EQ(read_cell("9.8e37", format_of({"1.5"})).kind, Cell::Kind::number);
}

TEST(TelemetryCells, AreReadWhereAColumnAgrees) {
  struct Case {
    std::vector<std::string_view> cells;
    double first;
    const char* unit;
  };
  for (const Case& c : {
           Case{{"\xE2\x88\x92"
                 "4.3",
                 "5"},
                -4.3,
                ""},
           Case{{"(4.2)", "4.1"}, -4.2, ""},
           Case{{"=\"4.2\"", "=\"4.1\""}, 4.2, ""},
           Case{{"0x1F", "0x20"}, 31, ""},
           Case{{"1.5D+02", "1.6D+02"}, 150, ""},
           Case{{"4.2 V", "4.3V"}, 4.2, "V"},
           Case{{"5.8 E-3", "5.9 E-3"}, 5.8e-3, ""},
           Case{{"5.8\u00D710^-3", "5.9\u00D710^-3"}, 5.8e-3, ""},
           Case{{"5.8 x 10^2", "5.9 x 10^2"}, 580, ""},
           Case{{"\u00A05.8", "\u00A05.9"}, 5.8, ""},
           Case{{"ON", "OFF"}, 1, ""},
           Case{{"False", "False"}, 0, ""},
           Case{{"1 (ON)", "0 (OFF)"}, 1, ""},
       }) {
    const CellFormat format = format_of(c.cells);
    const Cell cell = read_cell(c.cells[0], format);
    EXPECT_EQ(cell.kind, Cell::Kind::number) << c.cells[0];
    EXPECT_EQ(cell.value, c.first) << c.cells[0];
    EXPECT_EQ(format.unit, c.unit) << c.cells[0];
  }
}

TEST(TelemetryCells, MayHaveBlanksBehindTheSign) {
  auto opened = TelemetryFile::of_text("time,u\n2024-02-28,+  1.5\n2024-02-29,-  0.5\n", "t", {});
  auto& file = std::get<TelemetryFile>(opened);
  ASSERT_FALSE(file.find_time());
  for (const double value : {1.5, -0.5}) {
    ASSERT_EQ(file.next(), TelemetryFile::Step::row);
    EXPECT_EQ(file.cell(1).value, value);
  }
}

TEST(TelemetryCells, ThatDoNotAgreeAreBad) {
  std::vector<std::string_view> cells(20, "1.5");
  cells[7] = "1.5 V";
  EXPECT_EQ(read_cell(cells[7], format_of(cells)).kind, Cell::Kind::bad);
  EXPECT_EQ(format_of({"SUN", "ECLIPSE"}).kind, CellFormat::Kind::text);
  EXPECT_EQ(read_cell("", format_of(cells)).kind, Cell::Kind::blank);
  EXPECT_EQ(read_cell("NA", format_of(cells)).kind, Cell::Kind::bad);
  cells[9] = "<NA>";
  EXPECT_EQ(read_cell("NA ", format_of(cells)).kind, Cell::Kind::missing);
  EXPECT_EQ(describe(format_of(cells)), "<NA> is no value");
  EXPECT_EQ(read_cell("OFF", format_of({"ON", "ON"})).value, 0) << "the other state comes later";
}

TEST(TelemetryCells, WithAFlagOfLimitsAreFlagged) {
  std::vector<std::string_view> cells(20, "27.9");
  cells[3] = "28.4 H";
  const CellFormat format = format_of(cells);
  EXPECT_TRUE(read_cell("28.4 H", format).is_flagged);
  EXPECT_FALSE(read_cell("27.9", format).is_flagged);
}

TEST(TelemetryCells, NameTheStateThatNoNumberWasGivenFor) {
  ReadingOptions options;
  options.cells.states = {{"mode", {{"SAFE", 0}, {"SUN", 1}}}};
  const std::string text = "time,mode\n1,SAFE\n2,SUN\n3,EARTH\n";
  const auto file = std::get<TelemetryFile>(TelemetryFile::of_text(text, "t.csv", options));
  EXPECT_EQ(file.first_word(1), "'EARTH' in line 4");
  EXPECT_THAT(file.format(1).words, ElementsAre("EARTH"));
}

TEST(TelemetryCells, OfMissingValuesAndStatesAreAsGiven) {
  CellOptions options;
  options.missing = {"-999", "n/a"};
  options.states = {{"mode", *parse_states("SUN=1,ECLIPSE=0")}};
  const std::vector<std::string_view> numbers = {"1", "-999", "n/a"}, words = {"SUN", "ECLIPSE"};
  const CellFormat format = find_format(numbers, "x", {}, options);
  EXPECT_EQ(read_cell("-999.0", format).kind, Cell::Kind::missing);
  EXPECT_EQ(read_cell(" n/a ", format).kind, Cell::Kind::missing);
  EXPECT_EQ(read_cell("SUN", find_format(words, "mode", {}, options)).value, 1);
  EXPECT_EQ(find_format(words, "other", {}, options).kind, CellFormat::Kind::text);
}

}  // namespace
}  // namespace reident::telemetry_file::dialect_test
