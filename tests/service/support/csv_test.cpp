#include "service/support/csv.hpp"

#include <gtest/gtest.h>

namespace reident::csv::csv_test {
namespace {

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

}  // namespace
}  // namespace reident::csv::csv_test
