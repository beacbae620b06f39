#include "service/support/journal.hpp"

#include <gmock/gmock.h>

namespace reident::log {
namespace {

using namespace std::string_literals;
using testing::HasSubstr;
using testing::Not;

/// A field as the journal's native protocol has it, for values of less than 256 bytes.
std::string field(const std::string& name, const std::string& value) {
  return name + "\n" + static_cast<char>(value.size()) + "\0\0\0\0\0\0\0"s + value + "\n";
}

TEST(Journal, GetsTheLineWithItsPriorityAndComponent) {
  EXPECT_EQ(journal_entry(4, "archive", "archive: disk full", {{"retry_s", "1"}}),
            field("MESSAGE", "archive: disk full") + field("PRIORITY", "4") +
                field("COMPONENT", "archive") + field("RETRY_S", "1"));
}

TEST(Journal, KnowsTheSpacecraftOfAnEquipment) {
  const std::string entry = journal_entry(6, "league", "", {{"equipment", "SAT-1/BDR"}});
  EXPECT_THAT(entry, HasSubstr(field("EQUIPMENT", "SAT-1/BDR")));
  EXPECT_THAT(entry, HasSubstr(field("SPACECRAFT", "SAT-1")));
}

TEST(Journal, KnowsWhatAnAlarmIsAbout) {
  EXPECT_THAT(journal_entry(4, "alarm", "", {{"about", "SAT-1/BDR"}}),
              HasSubstr(field("EQUIPMENT", "SAT-1/BDR")));
  const std::string of_spacecraft = journal_entry(4, "alarm", "", {{"about", "SAT-1"}});
  EXPECT_THAT(of_spacecraft, HasSubstr(field("SPACECRAFT", "SAT-1")));
  EXPECT_THAT(of_spacecraft, Not(HasSubstr("EQUIPMENT")));
}

TEST(Journal, KeepsLineEndsOfAValue) {
  EXPECT_THAT(journal_entry(3, "x", "", {{"error", "a\nMESSAGE=b"}}),
              HasSubstr(field("ERROR", "a\nMESSAGE=b")));
}

}  // namespace
}  // namespace reident::log
