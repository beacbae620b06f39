#include "service/support/progress.hpp"

#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

namespace reident::progress_test {
namespace {

using namespace std::chrono_literals;

class ProgressTest : public testing::Test {
 protected:
  std::string drawn() {
    std::fflush(file_.get());
    std::string text(static_cast<std::size_t>(std::ftell(file_.get())), '\0');
    std::rewind(file_.get());
    text.resize(std::fread(text.data(), 1, text.size(), file_.get()));
    return text;
  }

  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_{std::tmpfile()};
  Progress::Clock::time_point start_{1h};
};

TEST_F(ProgressTest, SaysNothingWhereThereIsNoTerminal) {
  {
    Progress progress(file_.get());
    progress.update(0.5, "half", start_);
  }
  EXPECT_EQ(drawn(), "");
}

TEST_F(ProgressTest, DrawsTheFractionAndTheDetailAndClearsAfterItself) {
  {
    Progress progress(file_.get(), true);
    progress.update(0.5, "12 of 24 frames", start_);
  }
  EXPECT_EQ(drawn(), "\r\033[K[" + std::string(15, '#') + std::string(15, '.') +
                         "]  50 %  12 of 24 frames" + "\r\033[K");
}

TEST_F(ProgressTest, ShowsTheDetailAloneWhereNoEndIsKnown) {
  {
    Progress progress(file_.get(), true);
    progress.update("asking reident for 3 s", start_);
  }
  EXPECT_EQ(drawn(), "\r\033[Kasking reident for 3 s\r\033[K");
}

TEST_F(ProgressTest, DrawsAtMostTenTimesASecond) {
  Progress progress(file_.get(), true);
  for (int ms = 0; ms < 1000; ++ms) progress.update(0.1, "x", start_ + ms * 1ms);
  const std::string text = drawn();
  std::size_t bars = 0;
  for (auto at = text.find('['); at != std::string::npos; at = text.find("[#", at + 1)) ++bars;
  EXPECT_EQ(bars, 11U);  // find('[') meets the first escape sequence once
}

TEST_F(ProgressTest, HoldsFractionsToTheBar) {
  Progress progress(file_.get(), true);
  progress.update(7, "over", start_);
  progress.update(-3, "under", start_ + 1s);
  progress.update(std::numeric_limits<double>::quiet_NaN(), "none", start_ + 2s);
  const std::string text = drawn();
  EXPECT_NE(text.find("] 100 %  over"), std::string::npos);
  EXPECT_NE(text.find("]   0 %  under"), std::string::npos);
  EXPECT_NE(text.find("]   0 %  none"), std::string::npos);
}

}  // namespace
}  // namespace reident::progress_test
