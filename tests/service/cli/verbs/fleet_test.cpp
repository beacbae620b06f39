// `reident fleet`, as an operator calls it.
#include <algorithm>

#include <fmt/format.h>

#include "storage/database/database.hpp"
#include "tests/service/cli/cli_fixture.hpp"

namespace reident::cli::fleet_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class Fleet : public test::CliTest {
 protected:
  void write_table(int spacecraft) const {
    write("satellite.toml", R"([[spacecraft]]
name = "ANY"
[[spacecraft.equipment]]
name = "PLANT"
inputs = ["u"]
outputs = ["y"]
sample_period = "1s"
window = "10min"
)");
    std::string table = fmt::format(
        "[fleet]\nconfiguration = \"satellite.toml\"\ndata = \"{}/{{}}\"\n", folder().string());
    for (int i = 1; i <= spacecraft; ++i)
      table += fmt::format("[[spacecraft]]\nname = \"SAT-{}\"\n", i);
    write("fleet.toml", table);
  }
};

TEST_F(Fleet, ReplacesValuesOfHelmOnRequestAlone) {
  write_table(1);
  write("site.json", "mine\n");
  EXPECT_THAT(refusal_of({"fleet", "init", "fleet.toml", "--helm", "site.json"}),
              HasSubstr("--replace"));
  EXPECT_EQ(reident({"fleet", "init", "fleet.toml", "--helm", "site.json", "--replace"}).status, 0);
  EXPECT_EQ(reident({"fleet", "init", "fleet.toml", "--root", "root"}).status, 0);
}

TEST_F(Fleet, StatusOfAFileIsRefused) {
  write_table(1);
  EXPECT_THAT(refusal_of({"fleet", "status", "fleet.toml"}), HasSubstr("is a file"));
}

TEST_F(Fleet, StatusIsAScreenAtMost) {
  write_table(40);
  ASSERT_EQ(reident({"fleet", "init", "fleet.toml", "--root", "."}).status, 0);
  const auto lines = lines_on_terminal({"fleet", "status", "etc/reident"}, 80);
  EXPECT_THAT(lines, AllOf(SizeIs(::testing::Le(24U)), Contains(HasSubstr("--all lists them"))));
}

TEST_F(Fleet, StatusSaysWhereToFindWhyAServiceStopped) {
  write_table(1);
  ASSERT_EQ(reident({"fleet", "init", "fleet.toml", "--root", "."}).status, 0);
  std::filesystem::create_directory(folder() / "SAT-1");
  {
    const storage::Database left(folder() / "SAT-1/reident.db",
                                 storage::Database::Mode::read_write);
  }
  const test::Ran ran = reident({"fleet", "status", "etc/reident"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_THAT(ran.out, HasSubstr("journalctl -u reidentd@SAT-1"));
  write("etc/reident/SAT-1.toml", "wrong = 1\n");
  const std::string json = reident({"fleet", "status", "etc/reident", "--json"}).out;
  EXPECT_EQ(nlohmann::json::parse(json)["instances"][0]["service"], nullptr);
}

}  // namespace
}  // namespace reident::cli::fleet_test
