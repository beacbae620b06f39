// The extension on an archive whose closed years are in shards.
#include <cmath>

#include "storage/care/split.hpp"
#include "tests/storage/fixture.hpp"
#include "tests/storage/sql/sql_user.hpp"

namespace reident::storage::test::sql_shards_test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using Texts = std::vector<std::string>;

constexpr Time hour = 3'600'000'000'000;
constexpr Time begin_2023 = 19'358 * 24 * hour;

class SqlShards : public ::testing::Test {
 protected:
  SqlShards() {
    std::vector<TelemetryFrame> frames;
    for (std::uint64_t k = 0; k < 4000; ++k)  // a sample each six hours, from 2023 into 2025
      frames.push_back(frame(k, begin_2023 + static_cast<Time>(k) * 6 * hour,
                             {{1, Quality::good, std::sin(static_cast<double>(k))},
                              {2, Quality::good, static_cast<double>(k)}}));
    archive.append(frames);
    archive.compact();
  }
  Texts ask(const std::string& sql) const { return SqlUser(path).ask(sql); }

  TemporaryFolder folder;
  std::filesystem::path path = folder / "archive.db";
  Database database{path, Database::Mode::read_write};
  Archive archive{database, ArchiveOptions{.chunk_samples = 64}};
};

TEST_F(SqlShards, AnswersAreTheSameBeforeAndAfterTheSplit) {
  const std::vector<std::string> questions{
      "SELECT * FROM telemetry WHERE utc >= '2023-12-20' AND utc < '2024-01-10' ORDER BY time",
      "SELECT count(*), sum(value) FROM telemetry",
      "SELECT parameter, bucket, samples, mean, least, greatest, last_value "
      "FROM telemetry_summary('2023-02-01', NULL, '30d')",
      "SELECT time FROM telemetry WHERE parameter = '2' ORDER BY time DESC LIMIT 3000"};
  std::vector<Texts> before;
  for (const std::string& question : questions) before.push_back(ask(question));
  EXPECT_EQ(split_by_year(archive, 2025, [](const auto&) { return true; }).made.size(), 2U);
  for (std::size_t i = 0; i < questions.size(); ++i) EXPECT_EQ(ask(questions[i]), before[i]);
}

TEST_F(SqlShards, NamesAMissingShard) {
  const SplitReport report = split_by_year(archive, 2025, [](const auto&) { return true; });
  const auto shard = folder / "archive.db.shards" / report.made[0].file;
  std::filesystem::remove(shard);
  EXPECT_THAT(ask("SELECT sum(value) FROM telemetry"),
              ElementsAre(AllOf(StartsWith("error 14:"), HasSubstr(shard.string()))));
  EXPECT_THAT(ask("SELECT count(*) FROM telemetry WHERE utc >= '2024-06-01'"),
              ElementsAre(Not(StartsWith("error"))));
}

}  // namespace
}  // namespace reident::storage::test::sql_shards_test
