#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "service/fleet/instances.hpp"
#include "service/fleet/site_files.hpp"
#include "storage/registry/registry.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::test::fleet_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class FleetTest : public testing::Test {
 protected:
  fs::path configuration() const {
    std::ofstream(folder_ / "satellite.toml") << R"([archive]
keep = "400d"
[[spacecraft]]
name = "ANY"
[[spacecraft.equipment]]
name = "PLANT"
inputs = ["u", "v"]
outputs = ["y"]
sample_period = "1s"
window = "10min"
margin = 16.4
)";
    return folder_ / "satellite.toml";
  }

  Fleet site(std::vector<std::string> names) const {
    Fleet fleet;
    fleet.domain = 3;
    for (std::string& name : names) {
      FleetInstance one;
      one.configuration = configuration();
      one.partition = "operations/" + name;
      one.data = folder_ / name;
      one.spacecraft = name;
      one.name = std::move(name);
      fleet.instances.push_back(std::move(one));
    }
    return fleet;
  }

  void write(const Fleet& fleet) const {
    const auto files = fleet::site_files(fleet);
    fleet::write_site_files(files, fleet::change_of(files, folder_.path()), folder_.path());
  }

  std::string text_of(const fs::path& file) const {
    std::ifstream stream(folder_ / file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  const TemporaryFolder folder_;
};

TEST_F(FleetTest, WritesWhatTheServicesRead) {
  Fleet fleet = site({"SAT-1", "SAT-2"});
  fleet.instances[1].memory_max = "2G";
  fleet.instances[1].page = "127.0.0.1:8481";
  write(fleet);
  const auto loaded = load_config(folder_ / "etc/reident/SAT-2.toml");
  ASSERT_TRUE(std::holds_alternative<Config>(loaded));
  const auto& config = std::get<Config>(loaded);
  EXPECT_EQ(config.service_name, "SAT-2");
  EXPECT_EQ(config.domain, 3U);
  EXPECT_EQ(config.partition, "operations/SAT-2");
  EXPECT_EQ(config.database, folder_ / "SAT-2/reident.db");
  EXPECT_TRUE(config.keep);
  EXPECT_EQ(config.spacecraft[0].name, "SAT-2");
  EXPECT_EQ(config.spacecraft[0].equipment[0].name, "PLANT");
  EXPECT_THAT(text_of("etc/reident/SAT-2.toml"), HasSubstr(" margin = 16.4\n")) << "as it was";
  EXPECT_THAT(text_of("etc/systemd/system/reidentd@SAT-2.service.d/fleet.conf"),
              AllOf(HasSubstr("[Service]\n"), HasSubstr("\nMemoryMax=2G\n"),
                    HasSubstr("\nExecStartPre=+/usr/bin/install -d -o reident -g reident -m 0750 " +
                              (folder_ / "SAT-2").string() + "\n"),
                    Not(HasSubstr("CYCLONEDDS_URI"))));
  const auto targets = nlohmann::json::parse(text_of("etc/reident/targets.json"));
  ASSERT_EQ(targets.size(), 1U);
  EXPECT_EQ(targets[0]["targets"][0], "127.0.0.1:8481");
  EXPECT_EQ(targets[0]["labels"]["spacecraft"], "SAT-2");
}

TEST_F(FleetTest, ReplacesItsOwnFilesAlone) {
  write(site({"SAT-1"}));
  write(site({"SAT-1", "SAT-2"}));
  EXPECT_TRUE(fs::exists(folder_ / "etc/reident/SAT-2.toml"));
  std::ofstream(folder_ / "etc/reident/SAT-1.toml") << "# by hand\n";
  EXPECT_THROW(write(site({"SAT-0", "SAT-1"})), std::invalid_argument);
  EXPECT_EQ(text_of("etc/reident/SAT-1.toml"), "# by hand\n");
  EXPECT_FALSE(fs::exists(folder_ / "etc/reident/SAT-0.toml")) << "nothing was written";
}

TEST_F(FleetTest, SaysWhatChangesAndWhatTheTableHasLost) {
  const auto change = [&](const Fleet& fleet) {
    return fleet::change_of(fleet::site_files(fleet), folder_.path());
  };
  Fleet fleet = site({"SAT-1", "SAT-2", "SAT-3"});
  EXPECT_THAT(change(fleet).changed, IsEmpty()) << "none runs yet";
  write(fleet);
  std::ofstream(folder_ / "etc/reident/by-hand.toml") << "# by hand\n";
  EXPECT_THAT(change(fleet).changed, IsEmpty());
  EXPECT_THAT(change(fleet).gone, IsEmpty());
  fleet.instances.erase(fleet.instances.begin());
  fleet.instances[1].memory_max = "2G";
  EXPECT_THAT(change(fleet).changed, ElementsAre("SAT-3"));
  EXPECT_THAT(change(fleet).gone, ElementsAre("SAT-1"));
  fleet.network = FleetNetwork{"127.0.0.1", 1};
  for (FleetInstance& one : fleet.instances) one.host = "127.0.0.1";
  EXPECT_THAT(change(fleet).changed, ElementsAre("SAT-2", "SAT-3"));
  write(fleet);
  const fs::path middleware = "etc/reident/cyclonedds";
  std::ofstream(folder_ / middleware / "by-hand.xml") << "<CycloneDDS/>\n";
  fleet.network.reset();
  for (FleetInstance& one : fleet.instances) one.host.clear();
  fleet.instances.pop_back();
  EXPECT_THAT(change(fleet).gone, ElementsAre("SAT-1", "SAT-3"));
  write(fleet);
  EXPECT_FALSE(fs::exists(folder_ / middleware / "SAT-2-clients.xml")) << "nobody is there now";
  EXPECT_FALSE(fs::exists(folder_ / middleware / "clients.xml"));
  EXPECT_TRUE(fs::exists(folder_ / middleware / "SAT-3.xml")) << "its service may run";
  EXPECT_TRUE(fs::exists(folder_ / middleware / "by-hand.xml"));
}

TEST_F(FleetTest, WritesTheServicesOfOneMachine) {
  Fleet fleet = site({"SAT-1", "SAT-2"});
  fleet.network = FleetNetwork{"10.0.0.1", 1};
  fleet.instances[0].host = "10.0.0.1";
  fleet.instances[1].host = "10.0.0.2";
  const auto all = fleet::site_files(fleet), second = fleet::site_files(fleet, "10.0.0.2");
  for (const char* file : {"SAT-1.toml", "cyclonedds/SAT-1.xml"}) {
    EXPECT_TRUE(all.contains(fs::path("etc/reident") / file));
    EXPECT_FALSE(second.contains(fs::path("etc/reident") / file));
  }
  for (const char* file : {"SAT-2.toml", "cyclonedds/SAT-2.xml", "cyclonedds/SAT-1-clients.xml",
                           "cyclonedds/gateway-1.xml"})
    EXPECT_EQ(second.at(fs::path("etc/reident") / file), all.at(fs::path("etc/reident") / file));
  EXPECT_THROW(fleet::site_files(fleet, "10.0.0.3"), std::invalid_argument);
}

TEST_F(FleetTest, RefusesAConfigurationOfTwoSpacecraft) {
  Fleet two = site({"SAT-1"});
  std::ofstream(folder_ / "two.toml")
      << text_of("satellite.toml") << "[[spacecraft]]\nname = \"OTHER\"\n";
  two.instances[0].configuration = folder_ / "two.toml";
  EXPECT_THROW(fleet::site_files(two), std::invalid_argument);
}

TEST_F(FleetTest, NamesTheSpacecraftAndTheChangesThatAreWrong) {
  Fleet fleet = site({"SAT-1"});
  fleet.instances[0].partition = "operations/*";
  try {
    fleet::site_files(fleet);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("SAT-1"), HasSubstr("with the changes: [dds]")));
  }
}

TEST_F(FleetTest, TakesTheSecurityOfTheBaseFromItsFolder) {
  const Fleet fleet = site({"SAT-1"});
  std::ofstream(folder_ / "satellite.toml", std::ios::app) << "[dds]\nsecurity = \"keys\"\n";
  EXPECT_THAT(fleet::site_files(fleet).at("etc/reident/SAT-1.toml"),
              HasSubstr((folder_ / "keys").string()));
}

TEST_F(FleetTest, RefusesNamesWhoseFilesWouldBeOne) {
  for (const char* name : {"SAT-1-clients", "clients", "gateway-1"}) {
    Fleet fleet = site({"SAT-1", name});
    fleet::site_files(fleet);
    fleet.network = FleetNetwork{"127.0.0.1", 1};
    for (FleetInstance& one : fleet.instances) one.host = "127.0.0.1";
    EXPECT_THROW(fleet::site_files(fleet), std::invalid_argument) << name;
  }
}

TEST_F(FleetTest, GivesEachServiceAPortAndEachClientThoseThatItNeeds) {
  Fleet fleet = site({"SAT-1", "SAT-2", "SAT-3"});
  fleet.network = FleetNetwork{"10.0.0.1", 1};
  for (FleetInstance& one : fleet.instances) one.host = "10.0.0.1";
  fleet.instances[2].host = "10.0.0.2";
  const auto files = fleet::site_files(fleet);
  const auto middleware = [&](const std::string& name) {
    return files.at("etc/reident/cyclonedds/" + name + ".xml");
  };
  EXPECT_THAT(middleware("SAT-2"),
              AllOf(HasSubstr("<ParticipantIndex>1<"), HasSubstr("address=\"10.0.0.1\""),
                    HasSubstr("<Peers>\n<Peer address=\"10.0.0.1:8162\"/>\n</Peers>")))
      << "nobody but itself: without any the middleware asks other services";
  EXPECT_THAT(middleware("SAT-3"),
              AllOf(HasSubstr("<ParticipantIndex>0<"), HasSubstr("address=\"10.0.0.2\"")));
  // 7400 + 250 * 3 + 10 + 2 * index
  EXPECT_THAT(middleware("SAT-2-clients"),
              AllOf(HasSubstr("<ParticipantIndex>none<"), HasSubstr("10.0.0.1:8162"),
                    HasSubstr("10.0.0.1:8164"), Not(HasSubstr("10.0.0.1:8160"))))
      << "its service and the gateway";
  EXPECT_THAT(middleware("clients"), AllOf(HasSubstr("10.0.0.1:8160"), HasSubstr("10.0.0.1:8162"),
                                           HasSubstr("10.0.0.2:8160"), HasSubstr("10.0.0.1:8164")));
  EXPECT_THAT(middleware("gateway-1"),
              AllOf(HasSubstr("<ParticipantIndex>2<"), HasSubstr("10.0.0.2:8160"),
                    Not(HasSubstr("10.0.0.1:8164"))));
  EXPECT_THAT(files.at("etc/systemd/system/reidentd@SAT-3.service.d/fleet.conf"),
              AllOf(HasSubstr("cyclonedds/SAT-3.xml\n"), HasSubstr("IPAddressAllow=any\n")));
}

TEST_F(FleetTest, GivesAPairToASpacecraftWithAStandby) {
  std::ofstream(folder_ / "fleet.toml") << R"([fleet]
configuration = "satellite.toml"
standby = "10.0.0.2"
[fleet.network]
host = "10.0.0.1"
[[spacecraft]]
name = "SAT-1"
[[spacecraft]]
name = "SAT-2"
host = "10.0.0.3"
)";
  configuration();
  const auto table = load_fleet(folder_ / "fleet.toml");
  ASSERT_TRUE(std::holds_alternative<Fleet>(table));
  const auto files = fleet::site_files(std::get<Fleet>(table));
  const auto config_of = [&](const fs::path& name) {
    const auto parsed = parse_config(files.at("etc/reident" / name), folder_.path());
    return std::get<Config>(parsed);
  };
  const Config first = config_of("SAT-1.toml"), second = config_of("SAT-1-standby.toml");
  EXPECT_EQ(first.pair, "SAT-1");
  EXPECT_EQ(second.pair, "SAT-1");
  EXPECT_EQ(first.strength, 2);
  EXPECT_EQ(second.strength, 1);
  EXPECT_EQ(first.partition, second.partition);
  EXPECT_EQ(second.spacecraft[0].name, "SAT-1");
  const auto peers = AllOf(HasSubstr("10.0.0.1:7410"), HasSubstr("10.0.0.2:7410"));
  for (const char* name : {"SAT-1", "SAT-1-standby", "SAT-1-clients", "clients", "gateway-1"})
    EXPECT_THAT(files.at(fs::path("etc/reident/cyclonedds") / (name + std::string(".xml"))), peers)
        << name;
  EXPECT_THAT(files.at("etc/reident/cyclonedds/SAT-2.xml"),
              AllOf(HasSubstr("10.0.0.2:7412"), Not(HasSubstr("10.0.0.1:7410"))));
  const auto of_second = fleet::site_files(std::get<Fleet>(table), "10.0.0.2");
  EXPECT_TRUE(of_second.contains("etc/reident/SAT-2-standby.toml"));
  EXPECT_FALSE(of_second.contains("etc/reident/SAT-2.toml"));
}

TEST_F(FleetTest, TakesThePortsOfSeveralDomainsForManyServices) {
  std::vector<std::string> names;
  for (int i = 0; i < 200; ++i) names.push_back("SAT-" + std::to_string(i));
  Fleet fleet = site(names);
  fleet.network = FleetNetwork{"127.0.0.1", 0};
  for (FleetInstance& one : fleet.instances) one.host = "127.0.0.1";
  fleet.domain = 60;
  EXPECT_THAT(fleet::site_files(fleet).at("etc/reident/cyclonedds/SAT-199.xml"),
              AllOf(HasSubstr("<DomainGain>500<"), HasSubstr("<ParticipantIndex>199<")));
  fleet.domain = 150;
  EXPECT_THROW(fleet::site_files(fleet), std::invalid_argument);
}

TEST_F(FleetTest, ShowsTheWorstFirst) {
  write(site({"A", "B", "C"}));
  for (const char* name : {"A", "B"}) fs::create_directory(folder_ / name);
  const auto open = [&](const char* name) {
    return storage::Database(folder_ / name / "reident.db", storage::Database::Mode::read_write);
  };
  const storage::Database held = open("A");
  {
    storage::Database database = open("B");
    storage::Registry registry(database);
    registry.raise({"disk", {}, "no room", 1});
  }
  WorkerPool workers(2);
  const auto instances = fleet::read_instances(folder_ / "etc/reident", workers);
  ASSERT_EQ(instances.size(), 3U);
  EXPECT_EQ(instances[0].name, "C");
  EXPECT_THAT(instances[0].problem, HasSubstr("C/reident.db"));
  EXPECT_EQ(instances[1].name, "B");
  EXPECT_EQ(instances[1].has_service, false);
  EXPECT_EQ(instances[1].unseen_alarms(), 1U);
  EXPECT_EQ(instances[2].name, "A");
  EXPECT_EQ(instances[2].has_service, true);
  EXPECT_FALSE(instances[2].needs_action());
  EXPECT_EQ(instances[2].rows.size(), 1U) << "equipment that nothing was tried of";
  EXPECT_THROW(fleet::read_instances(folder_ / "A", workers), std::invalid_argument);
  std::ofstream(folder_ / "etc/reident/A.toml", std::ios::app) << "wrong = 1\n";
  const auto changed = fleet::read_instances(folder_ / "etc/reident", workers);
  const auto wrong = std::ranges::find(changed, "A", &fleet::Instance::name);
  EXPECT_EQ(wrong->has_service, std::nullopt) << "whose database is it?";
  EXPECT_TRUE(wrong->needs_action());
}

TEST_F(FleetTest, TellsASitesInstancesFromWhatTheyWereMadeOf) {
  write(site({"A"}));
  const fs::path folder = folder_ / "etc/reident";
  std::ofstream(folder / "fleet.toml") << "[fleet]\nconfiguration = \"reident.toml\"\n"
                                          "[[spacecraft]]\nname = \"A\"\n";
  for (const char* name : {"reident.toml", "hand.toml"})
    std::ofstream(folder / name) << "[archive]\ndatabase = \"" << fs::path(name).stem().string()
                                 << ".db\"\n"
                                 << text_of("satellite.toml").substr(sizeof "[archive]");
  fs::create_directory(folder / "folder.toml");
  { const storage::Database hand(folder / "hand.db", storage::Database::Mode::read_write); }
  WorkerPool workers(1);
  auto instances = fleet::read_instances(folder, workers);
  ASSERT_EQ(instances.size(), 4U) << "the table is none";
  EXPECT_EQ(instances[0].name, "A");
  instances.erase(instances.begin() + 1);  // the folder, a mistake
  EXPECT_EQ(instances[1].name, "hand") << "written by hand, and was started";
  EXPECT_TRUE(instances[1].needs_action());
  EXPECT_EQ(instances[2].name, "reident");
  EXPECT_FALSE(instances[2].is_of_site);
  EXPECT_FALSE(instances[2].needs_action());
  fs::remove(folder / "A.toml");
  EXPECT_TRUE(fleet::read_instances(folder, workers)[0].needs_action()) << "no table made any";
  fs::create_directory(folder_ / "tables");
  fs::copy(folder / "fleet.toml", folder_ / "tables");
  EXPECT_THROW(fleet::read_instances(folder_ / "tables", workers), std::invalid_argument);
}

}  // namespace
}  // namespace reident::test::fleet_test
