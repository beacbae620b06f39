#include "service/satcs/csv_export.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <unistd.h>

#include <gtest/gtest.h>

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

TEST(CsvExport, WritesEveryDigitAndBlanksForInvalidAndForNoSamples) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("reident-export-" + std::to_string(getpid()) + ".csv");
  ThreeRows stream;
  write_csv(stream, path);
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::filesystem::remove(path);
  EXPECT_EQ(text.str(),
            "unix_s,a,b\n-0.500000000,0.1,-1e-09\n1700000000.000000001,28,\n"
            "5,,3\n");
}

TEST(CsvExport, SaysWhyAFileCannotBeWritten) {
  ThreeRows stream;
  try {
    write_csv(stream, "/nowhere/t.csv");
    FAIL() << "written";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/t.csv: cannot be written: No such file or directory");
  }
}

}  // namespace
}  // namespace reident::satcs::csv_export_test
