#include "service/model/glossary.hpp"

#include <algorithm>

#include <gmock/gmock.h>

#include "identification/samples/verdict.hpp"
#include "service/model/reason_catalogue.hpp"

namespace reident::glossary_test {
namespace {

using identification::VerdictCode;

TEST(Glossary, HasAnEntryForEachOutcomeReasonAndVerdict) {
  for (const OutcomeRow& row : Catalogue::outcomes)
    EXPECT_TRUE(explanation_of(row.name)) << row.name;
  for (const ReasonRow& row : Catalogue::reasons) EXPECT_TRUE(explanation_of(row.name)) << row.name;
  for (int code = 0; code <= static_cast<int>(VerdictCode::no_gain); ++code) {
    const auto name = identification::name(static_cast<VerdictCode>(code));
    EXPECT_TRUE(explanation_of(name)) << name;
  }
}

TEST(Glossary, IsInOrderAndComplete) {
  EXPECT_TRUE(std::ranges::is_sorted(glossary(), std::less_equal<>(), &GlossaryEntry::code));
  for (const GlossaryEntry& entry : glossary()) {
    EXPECT_LE(entry.words.size(), 32U) << "for a line of a list: " << entry.code;
    EXPECT_TRUE(entry.meaning.ends_with('.')) << entry.code;
    EXPECT_TRUE(entry.remedy.empty() || entry.remedy.ends_with('.')) << entry.code;
  }
  EXPECT_EQ(explanation_of("nonsense"), nullptr);
}

}  // namespace
}  // namespace reident::glossary_test
