#include "service/client/name_pattern.hpp"

#include <string>

#include <gtest/gtest.h>

namespace reident::test::name_pattern_test {
namespace {

struct Case {
  const char* pattern;
  const char* name;
  bool matches;
};

TEST(NamePattern, TakesStarForAnyTextAndQuestionMarkForOneCharacter) {
  for (const Case& one : {Case{"BDR", "BDR", true},
                          {"BDR", "BDR2", false},
                          {"BDR2", "BDR", false},
                          {"bdr", "BDR", false},
                          {"", "", true},
                          {"", "B", false},
                          {"*", "", true},
                          {"*", "a/b..c", true},
                          {"BAT?", "BAT1", true},
                          {"BAT?", "BAT", false},
                          {"BAT?", "BAT12", false},
                          {"?", "\xc3\xa9", true},
                          {"??", "\xc3\xa9", false},
                          {"*?", "\xe2\x82\xac", true},
                          {"*\xc3\xa9*", "caf\xc3\xa9", true},
                          {"BAT*", "BAT", true},
                          {"*1", "SAG1A1", true},
                          {"*A*1", "SAG1A2", false},
                          {"a*b*c", "aXbXbXc", true},
                          {"**", "x", true},
                          {"[ab]", "a", false},
                          {"[ab]", "[ab]", true},
                          {"a\\*", "a\\b", true},
                          {"a\\*", "a*", false}}) {
    EXPECT_EQ(matches(one.pattern, one.name), one.matches) << one.pattern << " " << one.name;
  }
}

TEST(NamePattern, TakesNoMoreThanTheProductOfTheLengths) {
  std::string pattern;
  for (int i = 0; i < 100; ++i) pattern += "*a";
  EXPECT_FALSE(matches(pattern + "b", std::string(2000, 'a')));
}

}  // namespace
}  // namespace reident::test::name_pattern_test
