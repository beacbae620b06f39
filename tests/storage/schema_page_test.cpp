// SCHEMA.md says what the program does: its version, and each quality with its facts.
#include "storage/database/schema.hpp"
#include "storage/types/quality.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test::schema_page_test {
namespace {

using ::testing::HasSubstr;

TEST(SchemaPage, HasARowForEachQuality) {
  const std::string page = read_file(REIDENT_SCHEMA_PAGE);
  const auto yes_or_no = [](bool yes) { return std::string(yes ? "yes" : "no"); };
  for (const QualityFacts& row : quality_table)
    EXPECT_THAT(page,
                HasSubstr("\n| `" + std::string(row.name) + "` | " + std::to_string(row.wire) +
                          " | " + std::to_string(row.rank) + " | " + yes_or_no(row.is_usable) +
                          " | " + yes_or_no(row.is_sent) + " |"));
}

TEST(SchemaPage, NamesTheVersionOfTheSchema) {
  const std::string page = read_file(REIDENT_SCHEMA_PAGE), now = std::to_string(schema::version);
  EXPECT_THAT(page, HasSubstr("`user_version` is the version of the schema, now " + now + "."));
  EXPECT_THAT(page, HasSubstr("it becomes one of version " + now + " in one transaction"));
}

}  // namespace
}  // namespace reident::storage::test::schema_page_test
