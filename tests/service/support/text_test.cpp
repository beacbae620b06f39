#include "service/support/text.hpp"

#include <gmock/gmock.h>

namespace reident::text_test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Nearest, FindsWhatWasMeant) {
  const std::vector<std::string> names = {"overview", "history", "V_BUS", "I_BDRIN1", "I_BDRIN2"};
  EXPECT_EQ(nearest("overveiw", names), "overview");
  EXPECT_EQ(nearest("histroy", names), "history");
  EXPECT_EQ(nearest("v_bus", names), "V_BUS");
  EXPECT_EQ(nearest("I_BDRIN3", names), "I_BDRIN1");
  EXPECT_EQ(nearest("VBUS", names), "V_BUS");
}

TEST(Nearest, IsSilentWhereNothingIsNear) {
  EXPECT_EQ(nearest("temperature", {"overview", "history"}), "");
  EXPECT_EQ(nearest("at", {"plot", "why"}), "");
  EXPECT_EQ(nearest("x", {}), "");
  EXPECT_EQ(did_you_mean("x", {}), "");
  EXPECT_EQ(did_you_mean("histroy", {"history"}), " (did you mean history?)");
}

TEST(UnknownAmong, NamesThoseThatAreNotKnownAndWhatIsNear) {
  EXPECT_EQ(unknown_among({"V_BUS", "I_BUSS", "x"}, {"I_BUS", "V_BUS"}),
            "I_BUSS (did you mean I_BUS?); x");
  EXPECT_EQ(unknown_among({"V_BUS"}, {"V_BUS"}), "");
}

TEST(SplitNames, IsTheReverseOfJoined) {
  EXPECT_THAT(split_names("SAT/A, SAT/B"), ElementsAre("SAT/A", "SAT/B"));
  EXPECT_THAT(split_names(""), IsEmpty());
  EXPECT_EQ(joined(split_names("a, b, c")), "a, b, c");
}

}  // namespace
}  // namespace reident::text_test
