#include "service/support/terminal.hpp"

#include <algorithm>
#include <sstream>

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

namespace reident::terminal_test {
namespace {

using ::testing::Each;
using ::testing::Le;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string without_blanks(std::string text) {
  std::erase_if(text, [](char c) { return c == ' ' || c == '\n'; });
  return text;
}

TEST(Folded, ALineThatFitsStaysAsItIs) {
  EXPECT_EQ(folded("  a   b", 20), "  a   b");
  EXPECT_EQ(folded("", 20), "");
}

TEST(Folded, BreaksAtBlanksAndHangsBelowTheText) {
  EXPECT_EQ(folded("one two three four five six", 20), "one two three four\n  five six");
  EXPECT_EQ(folded("  --help   show all the options", 24),
            "  --help   show all the\n           options");
  EXPECT_EQ(folded("          begins far to the right", 24),
            "          begins far to\n          the right");
}

TEST(Folded, BreaksAWordThatNoLineCanHold) {
  EXPECT_EQ(folded("digest 0123456789abcdef0123456789abcdef", 20),
            "digest\n  0123456789abcdef01\n  23456789abcdef");
}

TEST(Folded, EscapeSequencesAndCodePointsCountAsTheyShow) {
  EXPECT_EQ(folded("\033[31m12345678901234567890\033[0m", 20),
            "\033[31m12345678901234567890\033[0m");
  EXPECT_EQ(folded("\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5 12345678", 20),
            "\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5\u00b5 12345678");
}

RC_GTEST_PROP(FoldedProperty, NoLineIsTooLongAndNothingIsLost, (const std::string& any)) {
  std::string line;
  for (const char c : any) line += c > ' ' && c < 0x7f ? c : ' ';
  const auto width = *rc::gen::inRange<std::size_t>(20, 130);
  const std::string text = folded(line, width);
  for (const std::string& one : lines_of(text)) RC_ASSERT(display_width(one) <= width);
  RC_ASSERT(without_blanks(text) == without_blanks(line));
}

}  // namespace
}  // namespace reident::terminal_test
