#include "service/cli/output/table.hpp"

#include <gtest/gtest.h>

namespace reident::cli::table_test {
namespace {

TEST(DisplayWidth, CountsCodePoints) {
  EXPECT_EQ(display_width(""), 0u);
  EXPECT_EQ(display_width("0.9 ± 0.1j"), 10u);
}

TEST(Table, AlignsItsColumns) {
  Table table({{"name"}, {"size", Table::Align::right}, {"note"}});
  table.add({"±", "7", "x"});
  table.add({"longer", "12345", ""});
  EXPECT_EQ(table.text(0),
            "name     size  note\n"
            "±           7  x\n"
            "longer  12345\n");
}

TEST(Table, WrapsItsLastColumnAtBlanks) {
  Table table({{"a"}, {"reason"}});
  table.add({"1", "the error is above the limit of the gate"});
  EXPECT_EQ(table.text(27),
            "a  reason\n"
            "1  the error is above the\n"
            "   limit of the gate\n");
}

TEST(Table, PutsTheLastColumnBelowWhereThereIsHardlyRoomForIt) {
  Table table({{"equipment"}, {"reason"}});
  table.add({"BDR", "the error is above the limit"});
  EXPECT_EQ(table.text(30),
            "equipment\n"
            "BDR\n"
            "    the error is above the\n"
            "    limit\n");
}

TEST(Table, GivesALongWordALineOfItsOwn) {
  Table table({{"a"}, {"b"}});
  table.add({"1", "x 01234567890123456789012345 y"});
  EXPECT_EQ(table.text(27), "a  b\n1  x\n   01234567890123456789012345\n   y\n");
}

}  // namespace
}  // namespace reident::cli::table_test
