#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::explain_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Explain : public test::CliTest {};

TEST_F(Explain, SaysWhatACodeMeansAndWhatToDo) {
  EXPECT_THAT(reident({"explain", "bias_unverified"}).out,
              AllOf(HasSubstr("waits: a sensor may be biased"), HasSubstr("What to do: Look")));
  EXPECT_EQ(json_of({"explain", "better"})["remedy"], nullptr);
  EXPECT_GT(json_of({"explain"})["codes"].size(), 40U);
  EXPECT_THAT(refusal_of({"explain", "bias_unverifed"}),
              HasSubstr("(did you mean bias_unverified?)"));
}

}  // namespace
}  // namespace reident::cli::explain_test
