#include "service/satcs/unheard_frames.hpp"

#include <gmock/gmock.h>

namespace reident::satcs {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr bool there = true;

/// Writes frames of the times [begin, end).
void write(UnheardFrames& frames, storage::Time begin, storage::Time end, bool readers) {
  for (storage::Time time = begin; time < end; ++time) frames.written(time, readers);
}

TEST(UnheardFrames, AreNotLostWhileTheHistoryHasThem) {
  UnheardFrames frames(10, 4);
  write(frames, 0, 10, !there);
  frames.acknowledged(10);  // the readers came back and got the history
  write(frames, 10, 20, !there);
  EXPECT_THAT(frames.lost(), IsEmpty());
}

TEST(UnheardFrames, AreLostWhenTheyLeaveTheHistory) {
  UnheardFrames frames(10, 4);
  write(frames, 0, 13, !there);
  EXPECT_THAT(frames.lost(), ElementsAre(LostFrames{3, 0, 2}));
}

TEST(UnheardFrames, AreOneHoleForEachTimeThatReadersWereAway) {
  UnheardFrames frames(2, 4);
  write(frames, 0, 5, !there);
  write(frames, 5, 8, there);
  frames.acknowledged(8);
  write(frames, 8, 11, !there);
  EXPECT_THAT(frames.lost(), ElementsAre(LostFrames{3, 0, 2}, LostFrames{1, 8, 8}));
}

TEST(UnheardFrames, WaitForAcknowledgementWhileReadersAreThere) {
  UnheardFrames frames(2, 6);
  write(frames, 0, 6, there);  // the network is cut, and the readers' lease lasts
  EXPECT_THAT(frames.lost(), IsEmpty());
  write(frames, 6, 7, !there);  // it has ended
  EXPECT_THAT(frames.lost(), ElementsAre(LostFrames{5, 0, 4}));
}

TEST(UnheardFrames, AreThoseBehindTheLastThatWasAcknowledged) {
  UnheardFrames frames(2, 100);
  write(frames, 0, 50, there);
  frames.acknowledged(45);
  frames.acknowledged(40);
  write(frames, 50, 51, !there);
  EXPECT_THAT(frames.lost(), ElementsAre(LostFrames{4, 45, 48}));
}

TEST(UnheardFrames, OfAStreamThatIsNeverQuietAreThoseOnTheWay) {
  UnheardFrames frames(2, 6);
  write(frames, 0, 1000, there);
  write(frames, 1000, 1001, !there);
  EXPECT_THAT(frames.lost(), ElementsAre(LostFrames{5, 994, 998}));
}

TEST(UnheardFrames, AreLostWhenTheWriterEnds) {
  UnheardFrames frames(10, 4);
  write(frames, 0, 3, !there);
  frames.ended();
  EXPECT_THAT(frames.lost(), ElementsAre(LostFrames{3, 0, 2}));
}

}  // namespace
}  // namespace reident::satcs
