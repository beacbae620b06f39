#include "service/satcs/csv_export.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace reident::satcs::csv_export_test {
namespace {

class ThreeRows : public FrameStream {
 public:
  std::vector<storage::ParameterDescriptor> parameters() const override {
    std::vector<storage::ParameterDescriptor> two(2);
    two[0].id = 1;
    two[0].name.assign(1, 'a');
    two[1].id = 2;
    two[1].name.assign(1, 'b');
    return two;
  }
  bool next(storage::TelemetryFrame& frame) override {
    using storage::Quality;
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    frame.generation_time = row_ == 0   ? -500'000'000
                            : row_ == 1 ? 1'700'000'000'000'000'001
                                        : 5'000'000'000;
    if (row_ == 0) frame.samples = {{1, Quality::good, 0.1}, {2, Quality::good, -1e-9}};
    if (row_ == 1) frame.samples = {{1, Quality::good, 28}, {2, Quality::invalid, nan}};
    if (row_ == 2) frame.samples = {{2, Quality::suspect, 3}};
    return row_++ < 3;
  }
  double progress() const override { return 0; }

 private:
  int row_ = 0;
};

std::string text_of(const std::filesystem::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST(CsvExport, WritesEveryDigitAndBlanksForInvalidAndForNoSamples) {
  const test::TemporaryFolder folder;
  ThreeRows stream;
  OutputFile file(folder / "t.csv");
  EXPECT_TRUE(write_csv(stream, file, {}));
  EXPECT_EQ(text_of(folder / "t.csv"),
            "unix_s,a,b\n-0.500000000,0.1,-1e-09\n1700000000.000000001,28,\n"
            "5,,3\n");
}

TEST(CsvExport, LeavesNoFileWhereItIsStopped) {
  const test::TemporaryFolder folder;
  ThreeRows stream;
  std::stop_source stop;
  stop.request_stop();
  {
    OutputFile file(folder / "t.csv");
    EXPECT_FALSE(write_csv(stream, file, stop.get_token()));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace reident::satcs::csv_export_test
