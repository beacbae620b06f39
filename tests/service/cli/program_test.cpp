// What concerns the program as a whole, and the commands that need no database.
#include <array>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include "service/dds/dds.hpp"
#include "service/support/terminal.hpp"
#include "tests/service/cli/cli_fixture.hpp"
#include "tests/support/wait_for_reader.hpp"

namespace reident::cli::program_test {
namespace {

using nlohmann::json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::SizeIs;
using ::testing::StartsWith;

class Program : public test::CliTest {};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST_F(Program, EveryVerbHasHelpWithAnExampleAndAPlaceInTheManual) {
  const std::string all = reident({"--help"}).out, manual = reident({"help", "--man"}).out;
  const std::vector<std::string> verbs = lines_of(reident({"help"}).out);
  EXPECT_THAT(verbs, SizeIs(::testing::Ge(28)));
  for (const std::string& line : verbs) {
    const std::string verb = line.substr(0, line.find(' '));
    EXPECT_THAT(all, HasSubstr(verb));
    EXPECT_THAT(manual, HasSubstr(".B " + verb + "\n"));
    const test::Ran ran = reident({verb, "--help"});
    EXPECT_EQ(ran.status, 0) << verb;
    EXPECT_THAT(ran.out, HasSubstr("Example:\n  reident " + verb)) << verb;
  }
}

TEST_F(Program, HelpOfEveryVerbFitsIntoTheTerminal) {
  std::vector<std::vector<std::string>> commands = {{"--help"}, {"help"}, {"histroy"}};
  for (const std::string& line : lines_of(reident({"help"}).out))
    commands.push_back({line.substr(0, line.find(' ')), "--help"});
  for (const unsigned short columns : std::array<unsigned short, 3>{60, 80, 120})
    for (const auto& command : commands) {
      const auto lines = lines_on_terminal(command, columns);
      EXPECT_THAT(lines, Not(IsEmpty())) << command[0];
      for (const std::string& line : lines)
        EXPECT_LE(display_width(line), columns) << command[0] << ": " << line;
    }
  const auto lines = lines_on_terminal({"overview", "--help"}, 120);
  EXPECT_THAT(lines, Contains(HasSubstr("over the last two cycles")))
      << "a sentence is broken by the terminal alone";
}

TEST_F(Program, ShellsCompleteVerbsAndOptions) {
  write("reident.bash", reident({"help", "--completion", "bash"}).out);
  const auto completions = [&](const std::string& words) {
    const std::string command = "cd " + folder().string() +
                                " && bash -c 'source ./reident.bash; COMP_WORDS=(" + words +
                                "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _reident; "
                                "echo \"${COMPREPLY[@]}\"' > out";
    EXPECT_EQ(system(command.c_str()), 0);
    std::ifstream out(folder() / "out");
    return std::string{std::istreambuf_iterator<char>(out), {}};
  };
  EXPECT_EQ(completions("reident over"), "overview\n");
  EXPECT_EQ(completions("reident history --equ"), "--equipment\n");
  EXPECT_EQ(completions("reident --remote history --outc"), "--outcome\n");
  EXPECT_THAT(reident({"help", "--completion", "fish"}).out,
              HasSubstr("'__fish_seen_subcommand_from overview' -l watch -d "));
  EXPECT_THAT(reident({"help", "--completion", "zsh"}).out, HasSubstr("#compdef reident\n"));
  EXPECT_THAT(refusal_of({"help", "--completion", "tcsh"}), HasSubstr("bash, zsh and fish"));
  EXPECT_THAT(reident({"help", "--man"}).out,
              AllOf(HasSubstr(".SS overview\n"), HasSubstr("\\-\\-watch")));
}

TEST_F(Program, NoCommandOfTheReadmeWritesIntoTheSources) {
  std::ifstream file(REIDENT_README);
  std::string before;
  for (std::string line; std::getline(file, line); before = line) {
    EXPECT_THAT(line, Not(AllOf(HasSubstr("reidentd"), HasSubstr("--config deploy/"))))
        << "the database is made next to the configuration";
    EXPECT_THAT(line, Not(ContainsRegex("(-o|--fmu|--mat) [a-z0-9]+\\.(svg|fmu|mat)")));
  }
}

TEST_F(Program, TheTableOfTheReadmeIsThatOfTheProgram) {
  std::ifstream file(REIDENT_README);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_THAT(page, HasSubstr("<!-- commands -->\n" + reident({"help", "--markdown"}).out +
                              "<!-- /commands -->\n"))
      << "put the output of 'reident help --markdown' between the marks";
}

TEST_F(Program, RemoteIsRefusedByVerbsThatReadNoHistory) {
  EXPECT_THAT(refusal_of({"--remote", "verify", "x.db"}),
              HasSubstr("verify works on the database file itself"));
  EXPECT_THAT(refusal_of({"--remote", "status"}),
              HasSubstr("status is none of the commands that read a database"));
}

TEST_F(Program, VersionIsPrinted) {
  EXPECT_THAT(reident({"version"}).out,
              MatchesRegex("reident [0-9]+\\.[0-9]+\\.[0-9]+(\\+[0-9a-f]+(-dirty)?)?\n"));
}

TEST_F(Program, WithoutACommandAndWithAnUnknownOneItIsRefused) {
  EXPECT_THAT(refusal_of({}), HasSubstr("see reident --help"));
  EXPECT_THAT(refusal_of({"indentify"}), HasSubstr("indentify (did you mean identify?)"));
  EXPECT_THAT(refusal_of({"--remote", "histroy"}), HasSubstr("(did you mean history?)"));
  EXPECT_THAT(refusal_of({"help", "histroy"}), HasSubstr("(did you mean history?)"));
}

TEST_F(Program, VersionAndHelpAreAskedForInEveryUsualWay) {
  EXPECT_EQ("reident " + reident({"--version"}).out, reident({"version"}).out);
  EXPECT_EQ(reident({"help", "plot"}).out, reident({"plot", "--help"}).out);
  EXPECT_THAT(reident({"-h"}).out, HasSubstr("Usage: reident "));
}

TEST_F(Program, ARefusedNumberIsNamedInALineThatPeopleRead) {
  EXPECT_THAT(refusal_of({"history", "--last", "0", "--db", "x"}),
              AllOf(HasSubstr("--last: 0 is no whole number above 0"),
                    ::testing::SizeIs(::testing::Le(100U))));
  EXPECT_THAT(refusal_of({"approve", "A/B", "1e3", "--reason", "x"}),
              HasSubstr("1e3 is no whole number above 0"));
}

TEST_F(Program, AStandardErrorThatCannotBeWrittenIsNoReasonToAbort) {
  for (const char* command : {" histroy", " history --db none.db", " check-config none.toml"})
    EXPECT_EQ(system(("cd " + folder().string() + " && " REIDENT_PROGRAM + command +
                      " > /dev/full 2> /dev/full")
                         .c_str()),
              2 << 8)
        << command;
}

TEST_F(Program, APipeThatNobodyReadsIsNoReasonToAbort) {
  const std::string ignored = "trap '' PIPE; " REIDENT_PROGRAM " help 2> err; echo $? > status";
  EXPECT_EQ(system(("cd " + folder().string() + " && (" + ignored + ") | true").c_str()), 0);
  std::ifstream status(folder() / "status");
  int code = -1;
  status >> code;
  EXPECT_THAT(code, ::testing::AnyOf(0, 1));
}

TEST_F(Program, AFullDiskIsAnError) {
  write("u.csv", "u1,y1\n");
  EXPECT_EQ(system(("cd " + folder().string() +
                    " && " REIDENT_PROGRAM " version > /dev/full 2> /dev/null")
                       .c_str()),
            1 << 8);
}

class CheckConfig : public test::CliTest {};

TEST_F(CheckConfig, ListsEveryMistakeWithFileAndLine) {
  write("bad.toml", "[service]\nworkers = 0\n[dds]\ndomian = 1\n");
  const test::Ran ran = reident({"check-config", "bad.toml"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_THAT(ran.err, HasSubstr("bad.toml:2: [service] workers must be"));
  EXPECT_THAT(ran.err, HasSubstr("bad.toml:4: [dds] domian is not known; did you mean domain?"));
  EXPECT_THAT(ran.err, HasSubstr("bad.toml: there is no spacecraft"));
  EXPECT_THAT(ran.err, HasSubstr("has 3 mistakes"));
  const test::Ran in_json = reident({"check-config", "bad.toml", "--json"});
  EXPECT_EQ(in_json.status, 2);
  const json printed = json::parse(in_json.out);
  EXPECT_EQ(printed["valid"], false);
  ASSERT_THAT(printed["mistakes"], SizeIs(3));
  EXPECT_EQ(printed["mistakes"][1]["line"], 2);
}

TEST_F(CheckConfig, SumsUpAGoodFile) {
  write("good.toml",
        "[[spacecraft]]\nname = \"A\"\n[[spacecraft.equipment]]\nname = \"X\"\n"
        "inputs = [\"u\"]\noutputs = [\"y\"]\nsample_period = \"1s\"\nwindow = \"1h\"\n");
  const test::Ran ran = reident({"check-config", "good.toml"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, HasSubstr("A/X"));
  EXPECT_THAT(ran.out, HasSubstr("u -> y"));
  const json printed = json_of({"check-config", "good.toml"});
  EXPECT_EQ(printed["valid"], true);
  EXPECT_THAT(printed["mistakes"], IsEmpty());
  EXPECT_EQ(printed["equipment"][0]["window"], "1h");
}

TEST_F(CheckConfig, ShowsWhatACutOfTheNetworkNeeds) {
  write("good.toml",
        "[dds]\ncut = \"60s\"\nrate = \"100/s\"\n"
        "[[spacecraft]]\nname = \"A\"\n[[spacecraft.equipment]]\nname = \"X\"\n"
        "inputs = [\"u\"]\noutputs = [\"y\"]\nsample_period = \"1s\"\nwindow = \"1h\"\n");
  EXPECT_THAT(reident({"check-config", "good.toml"}).out, HasSubstr("7500 frames"));
  const json cut = json_of({"check-config", "good.toml"})["network_cut"];
  EXPECT_EQ(cut["lease"], "70s");
  EXPECT_EQ(cut["source_history_frames"], 7500);
}

TEST_F(CheckConfig, SaysWhichEquipmentARelationChecksAndWhereItIsNone) {
  const std::string relation = "[[spacecraft.relation]]\ntolerance = 0.5\n";
  write("good.toml",
        "[[spacecraft]]\nname = \"A\"\n[[spacecraft.equipment]]\nname = \"X\"\n"
        "inputs = [\"u\"]\noutputs = [\"y\"]\nsample_period = \"1s\"\nwindow = \"1h\"\n" +
            relation + "name = \"two\"\nexpression = \"y - y_b\"\n" + relation +
            "name = \"misspelt\"\nexpression = \"yy - y_b\"\n");
  const test::Ran ran = reident({"check-config", "good.toml"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_THAT(ran.out, ContainsRegex("A/two +0.5 +X +y - y_b"));
  EXPECT_THAT(ran.out, ContainsRegex("A/misspelt +0.5 +no equipment +yy - y_b"));
  const json printed = json_of({"check-config", "good.toml"});
  EXPECT_EQ(printed["relations"][0]["equipment"], json({"X"}));
  EXPECT_EQ(printed["relations"][1]["equipment"], json::array());
  EXPECT_EQ(printed["relations"][1]["tolerance"], 0.5);
}

TEST_F(CheckConfig, RefusesAFileThatIsNotThere) {
  const test::Ran ran = reident({"check-config", "none.toml"});
  EXPECT_EQ(ran.status, 2);
  EXPECT_THAT(ran.err, StartsWith("none.toml: cannot be read"));
}

/// A service that only beats.
class Status : public test::CliTest {
 protected:
  const std::uint32_t domain = 31 + static_cast<std::uint32_t>(getpid()) % 170;
  const std::string partition = "cli-" + std::to_string(getpid());
  dds::Participant participant{{domain, partition}};
  dds::Writer<ServiceStatus> writer{participant};

  std::vector<std::string> command(std::vector<std::string> more) const {
    std::vector<std::string> words = {"status", "--domain", std::to_string(domain), "--partition",
                                      partition};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  ServiceStatus beat(int number) const {
    ServiceStatus status;
    status.service = "reident";
    status.program_version = "0.1.0";
    status.started = 1'700'000'000'000'000'000;
    status.time = status.started + number * 1'000'000'000LL;
    status.frames_received = 4321;
    status.newest_telemetry = status.started;
    status.failing_champions = "CBERS-4/MEA";
    return status;
  }
  /// Writes beat(0), beat(1), ... while the program runs.
  test::Ran run_beside(const std::function<ServiceStatus(int)>& next,
                       const std::vector<std::string>& arguments) {
    std::jthread beats([&](const std::stop_token& stop) {
      for (int number = 0; !stop.stop_requested(); ++number) {
        writer.write(next(number));
        std::this_thread::sleep_for(std::chrono::milliseconds(50));  // poll: the beat itself
      }
    });
    return reident(arguments);
  }
};

TEST_F(Status, IsWhatTheServiceSaidLast) {
  writer.write(beat(1));
  const json printed = json_of(command({"--timeout", "30"}));
  EXPECT_EQ(printed["service"], "reident");
  EXPECT_EQ(printed["frames_received"], 4321);
  EXPECT_EQ(printed["newest_telemetry"], "2023-11-14T22:13:20Z");
  EXPECT_EQ(printed["idle"], true);
  const test::Ran ran = reident(command({"--timeout", "30"}));
  EXPECT_THAT(ran.out, StartsWith("service reident (0.1.0), up since 2023-11-14T22:13:20Z, idle"));
  EXPECT_THAT(ran.out, HasSubstr("CBERS-4/MEA"));
}

TEST_F(Status, WaitsUntilTwoBeatsAreIdleAndAlike) {
  const test::Ran ran = run_beside(
      [this](int number) {
        ServiceStatus status = beat(number);
        status.windows_pending = number < 4 ? 1 : 0;
        status.attempts = static_cast<std::uint64_t>(std::min(number, 8));
        return status;
      },
      command({"--wait", "idle", "--timeout", "60", "--json"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(json::parse(ran.out)["attempts"], 8);
}

// A source may have ended, and the program begun, since the beat that a new reader gets first; what
// the source sent last may not be taken up yet at the next one.
TEST_F(Status, WaitsForTwoBeatsThatWereSentSinceItAsked) {
  const auto without_frames = [this](int number) {
    ServiceStatus status = beat(number);
    status.frames_received = 0;
    return status;
  };
  writer.write(without_frames(0));
  int since = 0;
  const test::Ran ran = run_beside(
      [&](int number) {
        if (since == 0) reident::test::wait_for_reader(writer);
        return since++ == 0 ? without_frames(number + 1) : beat(number + 1);
      },
      command({"--wait", "idle", "--timeout", "60", "--json"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(json::parse(ran.out)["frames_received"], 4321);
}

TEST_F(Status, ExitsFourWhenTheServiceStaysBusy) {
  const test::Ran ran = run_beside(
      [this](int number) {
        ServiceStatus status = beat(number);
        status.queue_length = 17;
        return status;
      },
      command({"--wait", "idle", "--timeout", "2"}));
  EXPECT_EQ(ran.status, 4);
  EXPECT_THAT(ran.err, HasSubstr("17 frames queued"));
}

TEST_F(Status, ExitsFourWhenNobodyIsHeard) {
  const test::Ran ran = reident(command({"--timeout", "0.3"}));
  EXPECT_EQ(ran.status, 4);
  EXPECT_THAT(ran.err, HasSubstr("check that reidentd runs"));
  writer.write(beat(1));
  EXPECT_EQ(reident(command({"--service", "other", "--timeout", "2"})).status, 4);
}

TEST_F(Status, RefusesWhatItCannotWaitFor) {
  EXPECT_THAT(refusal_of(command({"--wait", "forever"})), HasSubstr("idle"));
  EXPECT_THAT(refusal_of(command({"--timeout", "-1"})), HasSubstr("--timeout"));
  EXPECT_THAT(refusal_of({"status", "--domain", "300"}), HasSubstr("--domain"));
}

}  // namespace
}  // namespace reident::cli::program_test
