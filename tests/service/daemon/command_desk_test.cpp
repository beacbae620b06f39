// Commands over DDS: heard, executed, answered.
#include "service/daemon/command_desk.hpp"

#include <thread>

#include <gmock/gmock.h>

#include "tests/service/dds/dds_fixture.hpp"

namespace reident::test::command_desk_test {
namespace {

using storage::Command;
using storage::CommandOutcome;

CommandRequest request(std::uint64_t number, const std::string& service = "") {
  return {{"console", number, "hold", "SAT", "PLANT", 3, "Ana", "training"}, service};
}

/// A desk whose thread runs, and a console.
class Desk : public testing::Test {
 protected:
  dds::Participant service_{own_endpoint()};
  dds::Participant operator_{own_endpoint()};
  CommandDesk desk_{service_, "first", [] { return storage::Time{1}; }};
  dds::Writer<CommandRequest> commands_{operator_};
  dds::Reader<CommandReply> replies_{operator_};
  std::vector<Command> executed_;
  std::thread thread_;

  void run(const CommandDesk::Execute& execute) {
    thread_ = std::thread([this, execute] {
      desk_.run([&](const Command& command) {
        executed_.push_back(command);
        return execute(command);
      });
    });
    ASSERT_TRUE(eventually(
        [&] { return replies_.matched_writers() == 1 && commands_.matched_readers() == 1; }));
  }
  void stop() {
    desk_.stop();
    if (thread_.joinable()) thread_.join();
  }
  ~Desk() override { stop(); }

  /// Sends until the reply comes, as the command line does.
  CommandReply ask(const CommandRequest& asked) {
    std::optional<CommandReply> mine;
    eventually([&] {
      commands_.write(asked);
      return eventually(
          [&] {
            replies_.take(100, [&](CommandReply&& reply) {
              if (reply.request == asked.command.request) mine = std::move(reply);
            });
            return mine.has_value();
          },
          1s);
    });
    return mine.value_or(CommandReply{});
  }
};

TEST_F(Desk, ACommandArrivesAsItWasSentAndGetsItsOutcome) {
  run([](const Command&) { return CommandOutcome{true, "SAT/PLANT keeps version 3"}; });
  const CommandReply reply = ask(request(0xfffffffffffffff0));
  EXPECT_EQ(reply.requester, "console");
  EXPECT_TRUE(reply.outcome.ok);
  EXPECT_EQ(reply.outcome.reply, "SAT/PLANT keeps version 3");
  stop();
  EXPECT_THAT(executed_, testing::Each(request(0xfffffffffffffff0).command));
}

TEST_F(Desk, ACommandToAnotherServiceIsLeftAlone) {
  run([](const Command&) { return CommandOutcome{true, "done"}; });
  commands_.write(request(1, "second"));
  EXPECT_TRUE(ask(request(2, "first")).outcome.ok);
  EXPECT_TRUE(ask(request(3)).outcome.ok);
  stop();
  for (const Command& command : executed_) EXPECT_NE(command.request, 1U);
}

TEST_F(Desk, AFailureOfTheDatabaseIsTheAnswerAndTheNextCommandIsHeard) {
  run([](const Command& command) -> std::optional<CommandOutcome> {
    if (command.request == 1) throw storage::Error(storage::Error::Kind::full, "no room");
    return CommandOutcome{true, "done"};
  });
  const CommandReply reply = ask(request(1));
  EXPECT_FALSE(reply.outcome.ok);
  EXPECT_EQ(reply.outcome.reply, "no room");
  EXPECT_TRUE(ask(request(2)).outcome.ok);
}

TEST_F(Desk, WhatAStoppingServiceCannotExecuteGetsNoAnswer) {
  run([](const Command& command) -> std::optional<CommandOutcome> {
    if (command.request == 1) return std::nullopt;
    return CommandOutcome{true, "done"};
  });
  commands_.write(request(1));
  EXPECT_EQ(ask(request(2)).request, 2U);
  replies_.take(100, [](CommandReply&& reply) { EXPECT_EQ(reply.request, 2U); });
}

}  // namespace
}  // namespace reident::test::command_desk_test
