// Fields can be added to a topic's type without breaking programs compiled before.
#include <array>
#include <cstdio>

#include <gmock/gmock.h>

#include "tests/service/dds/child.hpp"
#include "tests/service/dds/dds_fixture.hpp"
#include "tests/service/model/example_model.hpp"

namespace reident::test::older_program_test {
namespace {

class OlderProgram : public testing::Test {
 protected:
  void SetUp() override { setenv("CYCLONEDDS_URI", LOOPBACK_URI, 1); }
  void TearDown() override { unsetenv("CYCLONEDDS_URI"); }

  std::vector<std::string> command(const std::string& what) const {
    return {OLDER_PROGRAM, what, std::to_string(endpoint_.domain), endpoint_.partition};
  }
  /// The first line that it prints.
  std::string said(const std::string& what) const {
    std::string line;
    for (const std::string& word : command(what)) line += word + " ";
    FILE* program = popen(line.c_str(), "r");
    if (program == nullptr) return "cannot be started";
    std::array<char, 400> text{};
    const bool has_line = fgets(text.data(), text.size(), program) != nullptr;
    return pclose(program) == 0 && has_line ? text.data() : "no line";
  }
  dds::Endpoint endpoint_ = own_endpoint();
};

TEST_F(OlderProgram, ReadsAVersionThatHasFieldsItDoesNotKnow) {
  dds::Participant participant(endpoint_);
  dds::Writer<ModelVersion> writer(participant);
  writer.write(example_version(3));
  EXPECT_EQ(said("read"), "CBERS4/BDR 3 " + example_version(3).digest + " I_BDRIN1 0.9 1\n");
}

TEST_F(OlderProgram, HearsWhichVersionANewerSimulatorRuns) {
  dds::Participant participant(endpoint_);
  dds::Writer<ModelAcknowledgement> writer(participant);
  ModelAcknowledgement message{"trainer", "CBERS4", "BDR", 3, "ab", true, "", {}, "host", 7, "1.0"};
  message.running.version = 3;
  message.running.mrse_percent = 2.5;
  writer.write(message);
  EXPECT_EQ(said("hear"), "trainer CBERS4/BDR 3 1 2.5\n");
}

TEST_F(OlderProgram, ThatRunsAVersionIsKnownToRunIt) {
  dds::Participant participant(endpoint_);
  dds::Reader<ModelAcknowledgement> reader(participant);
  const Child child(command("acknowledge"));
  const auto messages = take_all(reader, 1);
  ASSERT_EQ(messages.size(), 1U) << reader.last_malformed();
  RunningModel running;
  running.version = 4;
  running.since = 5;
  running.mrse_percent = 1.5;
  EXPECT_EQ(messages[0].running, running);
  EXPECT_EQ(messages[0].host, "");
  EXPECT_EQ(messages[0].program_version, "");
}

TEST_F(OlderProgram, IsReadWithWhatItDoesNotSayLeftEmpty) {
  dds::Participant participant(endpoint_);
  dds::Reader<ModelVersion> reader(participant);
  const Child child(command("write"));
  const auto versions = take_all(reader, 1);
  ASSERT_EQ(versions.size(), 1U) << reader.last_malformed();
  EXPECT_EQ(versions[0].number, 4);
  EXPECT_EQ(versions[0].model.method, "");
  EXPECT_EQ(versions[0].model.validation.rows, 0);
  EXPECT_EQ(versions[0].model.inputs[0].expression, "");
  EXPECT_FALSE(versions[0].model.tracking);
  EXPECT_EQ(versions[0].model.inputs[0].low, -1);
  EXPECT_EQ(versions[0].model.inputs[0].high, 0);
  EXPECT_EQ(versions[0].model.dynamics.A(0, 0), 0.5);
}

}  // namespace
}  // namespace reident::test::older_program_test
