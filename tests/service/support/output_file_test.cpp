#include "service/support/output_file.hpp"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.hpp"

namespace reident::output_file_test {
namespace {

namespace fs = std::filesystem;
using Existing = OutputFile::Existing;

class OutputFiles : public testing::Test {
 protected:
  fs::path path() const { return folder_ / "a.txt"; }
  void make(const std::string& content) const { std::ofstream(path()) << content; }
  std::string content() const {
    std::stringstream text;
    text << std::ifstream(path()).rdbuf();
    return text.str();
  }
  std::ptrdiff_t files() const {
    return std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator());
  }

 private:
  const test::TemporaryFolder folder_;
};

TEST_F(OutputFiles, HaveTheirNameWhenAllOfThemIsThere) {
  for (const Existing existing : {Existing::kept, Existing::replaced}) {
    OutputFile file(path(), existing);
    file.write("new");
    EXPECT_NE(content(), "new");
    file.finish();
    EXPECT_EQ(content(), "new");
    make("old");
  }
}

TEST_F(OutputFiles, LeaveAloneWhatCameMeanwhileWhereTheyAreToKeepIt) {
  {
    OutputFile file(path(), Existing::kept);
    file.write("new");
    make("old");
    try {
      file.finish();
      FAIL() << "the file was replaced";
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("a.txt cannot be written: File exists"));
    }
  }
  EXPECT_EQ(content(), "old");
  EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace reident::output_file_test
