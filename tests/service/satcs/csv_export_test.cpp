#include "service/satcs/csv_export.hpp"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <unistd.h>

#include <gtest/gtest.h>

namespace reident::satcs {
namespace {

class TwoRows : public FrameSource {
 public:
  std::vector<storage::ParameterDescriptor> parameters() const override {
    std::vector<storage::ParameterDescriptor> two(2);
    two[0].name.assign(1, 'a');
    two[1].name.assign(1, 'b');
    return two;
  }
  bool next(storage::Time& time, std::vector<storage::Sample>& samples) override {
    using storage::Quality;
    if (row_ == 2) return false;
    time = row_ == 0 ? -500'000'000 : 1'700'000'000'000'000'001;
    samples = {{1, Quality::good, row_ == 0 ? 0.1 : 28},
               {2, row_ == 0 ? Quality::good : Quality::invalid,
                row_ == 0 ? -1e-9 : std::numeric_limits<double>::quiet_NaN()}};
    ++row_;
    return true;
  }
  double progress() const override { return 0; }

 private:
  int row_ = 0;
};

TEST(CsvExport, WritesEveryDigitAndBlanksForInvalidSamples) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("reident-export-" + std::to_string(getpid()) + ".csv");
  TwoRows source;
  write_csv(source, path);
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  std::filesystem::remove(path);
  EXPECT_EQ(text.str(), "unix_s,a,b\n-0.500000000,0.1,-1e-09\n1700000000.000000001,28,\n");
}

TEST(CsvExport, SaysWhyAFileCannotBeWritten) {
  TwoRows source;
  try {
    write_csv(source, "/nowhere/t.csv");
    FAIL() << "written";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/t.csv: cannot be written: No such file or directory");
  }
}

}  // namespace
}  // namespace reident::satcs
