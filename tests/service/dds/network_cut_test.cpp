#include "service/dds/network_cut.hpp"

#include <gtest/gtest.h>

namespace reident::dds {
namespace {

using namespace std::chrono_literals;

TEST(NetworkCut, KeepsParticipantsTogetherForLongerThanItLasts) {
  EXPECT_EQ(settings_for({60s, 100}, 72).lease, 70s);
}

TEST(NetworkCut, NeedsTheFramesThatComeUntilParticipantsHaveFoundEachOther) {
  EXPECT_EQ(settings_for({60s, 100}, 72).history, 7500);
  EXPECT_EQ(settings_for({60s, 0.01}, 72).history, 1);
  EXPECT_EQ(settings_for({24h, 1e9}, 72).history, 2'000'000'000);
}

TEST(NetworkCut, HoldsNoSourceBackThatKeepsToItsRate) {
  constexpr std::uint64_t bytes_on_the_wire = 60 + 13 * 629;
  EXPECT_GE(settings_for({60s, 100}, 629).unacknowledged_bytes, 7000 * bytes_on_the_wire);
  EXPECT_EQ(settings_for({1s, 0.1}, 1).unacknowledged_bytes, 500'000) << "the middleware's own";
}

}  // namespace
}  // namespace reident::dds
