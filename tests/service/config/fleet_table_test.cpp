#include "service/config/fleet_table.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace reident::test::fleet_table_test {
namespace {

using testing::HasSubstr;

class FleetTable : public testing::Test {
 protected:
  std::variant<Fleet, std::vector<ConfigMistake>> load(const std::string& text) const {
    std::ofstream(folder_ / "fleet.toml") << text;
    return load_fleet(folder_ / "fleet.toml");
  }
  Fleet fleet(const std::string& text) const {
    const auto loaded = load(text);
    if (const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded))
      ADD_FAILURE() << mistakes->front().message;
    return std::get<Fleet>(loaded);
  }
  ConfigMistake mistake(const std::string& text) const {
    const auto loaded = load(text);
    const auto* mistakes = std::get_if<std::vector<ConfigMistake>>(&loaded);
    return mistakes ? mistakes->front() : ConfigMistake{0, "none"};
  }

  const TemporaryFolder folder_;
};

TEST_F(FleetTable, GivesEachSpacecraftWhatAllHaveAndItsOwn) {
  const Fleet site = fleet(R"([fleet]
configuration = "one.toml"
domain = 7
memory_max = "1G"
[[spacecraft]]
name = "SAT-1"
[[spacecraft]]
name = "SAT-2"
configuration = "two.toml"
partition = "test/SAT-2"
data = "/data/two"
memory_max = "2G"
page = "127.0.0.1:8481"
)");
  EXPECT_EQ(site.domain, 7U);
  EXPECT_FALSE(site.network);
  ASSERT_EQ(site.instances.size(), 2U);
  const FleetInstance &one = site.instances[0], &two = site.instances[1];
  EXPECT_EQ(one.configuration, folder_ / "one.toml");
  EXPECT_EQ(one.partition, "operations/SAT-1");
  EXPECT_EQ(one.data, "/var/lib/reident/SAT-1");
  EXPECT_EQ(one.memory_max, "1G");
  EXPECT_EQ(one.page, std::nullopt);
  EXPECT_EQ(two.configuration, folder_ / "two.toml");
  EXPECT_EQ(two.partition, "test/SAT-2");
  EXPECT_EQ(two.data, "/data/two");
  EXPECT_EQ(two.memory_max, "2G");
  EXPECT_EQ(two.page, "127.0.0.1:8481");
}

TEST_F(FleetTable, NamesEachMistakeWithItsLine) {
  const struct {
    const char* text;
    std::uint32_t line;
    const char* words;
  } cases[] = {
      {"", 0, "[[spacecraft]]"},
      {"[[spacecraft]]\nname = \"SAT-1\"\n", 1, "configuration"},
      {"[fleet]\nconfiguration = \"x\"\n[[spacecraft]]\nname = \"SAT/1\"\n", 4, "letters"},
      {"[fleet]\nconfiguration = \"x\"\n[[spacecraft]]\nname = \"A\"\ndata = \"here\"\n", 5,
       "absolute"},
      {"[fleet]\nconfiguraton = \"x\"\n[[spacecraft]]\nname = \"A\"\n", 2, "configuraton"},
      {"[fleet]\nconfiguration = \"x\"\n[[spacecraft]]\nname = \"A\"\n[[spacecraft]]\nname = "
       "\"A\"\n",
       6, "the name"},
      {"[fleet]\nconfiguration = \"x\"\npartition = \"all\"\n[[spacecraft]]\nname = \"A\"\n"
       "[[spacecraft]]\nname = \"B\"\n",
       6, "partition all"},
      {"[fleet]\nconfiguration = \"x\"\n[fleet.network]\ngateways = 2\n[[spacecraft]]\nname = "
       "\"A\"\n",
       3, "host"},
      {"[fleet]\nconfiguration = \"x\"\n[fleet.network]\nhost = \"station\"\n[[spacecraft]]\nname "
       "= "
       "\"A\"\n",
       4, "station"},
      {"[fleet]\nconfiguration = \"x\"\nmemory_max = \"1 GB\"\n[[spacecraft]]\nname = \"A\"\n", 3,
       "1 GB"},
      {"[fleet]\nconfiguration = \"x\"\ncpu_quota = \"half\"\n[[spacecraft]]\nname = \"A\"\n", 3,
       "half"},
      {"[fleet]\nconfiguration = \"x\"\n[[spacecraft]]\nname = \"A.service\"\n", 4, ".service"},
      {"[fleet]\nconfiguration = \"x\"\n[[spacecraft]]\nname = \"A\"\ndata = \"/my data\"\n", 5,
       "blanks"},
      {"[fleet]\nconfiguration = \"x\"\n[[spacecraft]]\nname = \"A\"\npage = \"h:1\"\n"
       "[[spacecraft]]\nname = \"B\"\npage = \"h:1\"\n",
       8, "page h:1"},
      {"[fleet]\nconfiguration = \"x\"\nstandby = \"10.0.0.2\"\n[[spacecraft]]\nname = \"A\"\n", 3,
       "[fleet.network]"},
      {"[fleet]\nconfiguration = \"x\"\n[fleet.network]\nhost = \"10.0.0.1\"\n[[spacecraft]]\nname "
       "= "
       "\"A\"\nstandby = \"10.0.0.1\"\n",
       7, "another machine"},
      {"[fleet]\nconfiguration = \"x\"\ndata = \"/x\"\n[[spacecraft]]\nname = \"A\"\n"
       "[[spacecraft]]\nname = \"B\"\ndata = \"//x/./\"\n",
       8, "folder /x"},
  };
  for (const auto& [text, line, words] : cases) {
    const ConfigMistake found = mistake(text);
    EXPECT_EQ(found.line, line) << text;
    EXPECT_THAT(found.message, HasSubstr(words)) << text;
  }
}

TEST_F(FleetTable, RefusesAPageThatIsNoHostAndPort) {
  for (const char* page : {"", "8480", "host", "host:", ":8480", "host:0", "host:70000", "host:80a",
                           "http://host:80", "my host:80"})
    EXPECT_THAT(mistake("[fleet]\nconfiguration = \"x\"\n[[spacecraft]]\nname = \"A\"\npage = \"" +
                        std::string(page) + "\"\n")
                    .message,
                HasSubstr("host and port"))
        << page;
  EXPECT_EQ(fleet("[fleet]\nconfiguration = \"x\"\n[[spacecraft]]\nname = \"A\"\npage = "
                  "\"[::1]:8480\"\n")
                .instances[0]
                .page,
            "[::1]:8480");
}

TEST_F(FleetTable, TakesTheLimitsThatSystemdTakes) {
  const auto table = [](const std::string& key, const std::string& limit) {
    return "[fleet]\nconfiguration = \"x\"\n" + key + " = \"3" + (key == "cpu_quota" ? "%" : "G") +
           "\"\n[[spacecraft]]\nname = \"A\"\n" + key + " = \"" + limit + "\"\n";
  };
  const std::pair<const char*, const char*> good[] = {
      {"memory_max", "512M"}, {"memory_max", "1.5G"}, {"memory_max", "1000000"},
      {"memory_max", "60%"},  {"cpu_quota", "12.5%"}, {"cpu_quota", "400%"},
  };
  for (const auto& [key, limit] : good) {
    const FleetInstance one = fleet(table(key, limit)).instances[0];
    EXPECT_EQ(std::string_view(key) == "cpu_quota" ? one.cpu_quota : one.memory_max, limit);
  }
  for (const char* key : {"memory_max", "cpu_quota"}) {
    const FleetInstance one = fleet(table(key, "infinity")).instances[0];
    EXPECT_FALSE(one.memory_max || one.cpu_quota) << "not that of [fleet] either";
  }
  const std::pair<const char*, const char*> wrong[] = {
      {"memory_max", "0"},    {"memory_max", "0G"},  {"memory_max", "99999999999G"},
      {"memory_max", "101%"}, {"memory_max", "G"},   {"memory_max", "1.2.3G"},
      {"memory_max", "-1G"},  {"cpu_quota", "0%"},   {"cpu_quota", "0.001%"},
      {"cpu_quota", "2"},     {"cpu_quota", "1e2%"},
  };
  for (const auto& [key, limit] : wrong)
    EXPECT_THAT(mistake(table(key, limit)).message, HasSubstr("no limit of systemd"))
        << key << ' ' << limit;
}

TEST_F(FleetTable, SaysThatAFolderIsNone) {
  const auto loaded = load_fleet(folder_.path());
  EXPECT_THAT(std::get<std::vector<ConfigMistake>>(loaded)[0].message, HasSubstr("folder"));
}

TEST(FleetExample, IsRead) {
  const auto example = load_fleet(REIDENT_EXAMPLES "/fleet.toml");
  ASSERT_TRUE(std::holds_alternative<Fleet>(example));
  for (const FleetInstance& one : std::get<Fleet>(example).instances)
    EXPECT_TRUE(std::holds_alternative<Config>(load_config(one.configuration)));
}

}  // namespace
}  // namespace reident::test::fleet_table_test
