#include "service/history/model_parameters.hpp"

#include <gmock/gmock.h>

namespace reident::history {
namespace {

using ::testing::ElementsAre;

TEST(ModelParameters, AreOfInputsAndOutputsWhereverTheyStand) {
  EXPECT_THAT(parameters_of(R"({"inputs":[{"name":"U","unit":"V"},{"name":"I"}],)"
                            R"("outputs":[{"name":"Y"}],"A":[[0.9]]})"),
              ElementsAre("U", "I", "Y"));
  EXPECT_THAT(parameters_of(R"({"A":[[0.9]],"outputs":[{"name":"Y"}],"name":"no signal",)"
                            R"("x":{"inputs":[{"name":"none"}]},"inputs":[{"name":"U"}]})"),
              ElementsAre("U", "Y"));
}

TEST(ModelParameters, AreThoseThatExpressionsUse) {
  EXPECT_THAT(parameters_of(R"({"inputs":[{"name":"P","expression":"U*I"},{"name":"U"}],)"
                            R"("outputs":[{"name":"Y"}]})"),
              ElementsAre("U", "I", "Y"));
}

TEST(ModelParameters, AreNotReadBehindTheSignals) {
  EXPECT_THAT(parameters_of(R"({"inputs":[],"outputs":[{"name":"Y"}],"A":[[damaged)"),
              ElementsAre("Y"));
}

TEST(ModelParameters, OfWhatIsNoModelAreAnError) {
  for (const char* text : {"", "{", "[]", R"({"inputs":[{"name":"U"}]})", R"({"inputs":7})"})
    EXPECT_THROW(parameters_of(text), std::exception) << text;
}

}  // namespace
}  // namespace reident::history
