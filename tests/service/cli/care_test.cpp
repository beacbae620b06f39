// backup on a real database, as an operator calls it.
#include "storage/archive.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr std::int64_t second = 1'000'000'000;
constexpr std::int64_t start = 1'700'000'000 * second;  // 2023-11-14T22:13:20Z

class Care : public testing::CliTest {
 protected:
  Care() { append(0, 600); }

  std::filesystem::path path() const { return folder() / "reident.db"; }
  /// One frame a second with V_BUS (1) and I_BUS (2).
  void append(std::uint64_t from, std::uint64_t to) const {
    storage::Database database(path(), storage::Database::Mode::read_write);
    storage::Archive archive(database);
    archive.describe(std::vector{descriptor(1, "V_BUS"), descriptor(2, "I_BUS")});
    std::vector<storage::TelemetryFrame> frames;
    for (std::uint64_t k = from; k < to; ++k) {
      storage::TelemetryFrame frame;
      frame.spacecraft = "CB4";
      frame.source = "station";
      frame.sequence = k;
      frame.generation_time = start + static_cast<std::int64_t>(k) * second;
      frame.samples = {{1, storage::Quality::good, 28 + static_cast<double>(k % 7)},
                       {2, storage::Quality::good, static_cast<double>(k)}};
      frames.push_back(frame);
    }
    archive.append(frames);
  }
  static storage::ParameterDescriptor descriptor(std::uint32_t id, const std::string& name) {
    storage::ParameterDescriptor one;
    one.spacecraft = "CB4";
    one.id = id;
    one.name = name;
    return one;
  }
};

TEST_F(Care, BackupSaysWhatItCopied) {
  const testing::Ran ran = reident({"backup", "reident.db", "copy.db"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.err, "");
  EXPECT_EQ(ran.out, (folder() / "copy.db").string() + ": " +
                         std::to_string(std::filesystem::file_size(folder() / "copy.db")) +
                         " bytes, 1200 samples up to 2023-11-14T22:23:19Z, "
                         "0 versions of models\n");
  append(600, 700);
  const json again = json_of({"backup", "reident.db", "copy.db", "--replace"});
  EXPECT_EQ(again["samples"], 1400);
  EXPECT_EQ(again["newest"], "2023-11-14T22:24:59Z");
  storage::Database copy(folder() / "copy.db", storage::Database::Mode::read_only);
  EXPECT_EQ(storage::Archive(copy).sample_count(), 1400U);
}

TEST_F(Care, BackupRefusesInOneLineWithTheRemedy) {
  write("taken.db", "something else");
  EXPECT_THAT(refusal_of({"backup", "reident.db", "taken.db"}), HasSubstr("--replace"));
  EXPECT_THAT(refusal_of({"backup", "reident.db", "reident.db", "--replace"}),
              HasSubstr("is the database itself"));
  EXPECT_THAT(refusal_of({"backup", "reident.db", "no/folder/copy.db"}),
              HasSubstr("does not exist"));
  EXPECT_THAT(refusal_of({"backup", "nothing.db", "copy.db"}), HasSubstr("does not exist"));
  EXPECT_THAT(refusal_of({"backup", "taken.db", "copy.db"}), HasSubstr("is not a database"));
  EXPECT_THAT(refusal_of({"backup", "reident.db"}), HasSubstr("copy is required"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "copy.db"));
}

TEST_F(Care, BackupWorksWhileAServiceHoldsTheFile) {
  const storage::Database service(path(), storage::Database::Mode::read_write);
  EXPECT_EQ(json_of({"backup", "reident.db", "copy.db"})["samples"], 1200);
}

}  // namespace
}  // namespace reident::cli
