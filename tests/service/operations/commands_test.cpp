// Each order of an operator has one clear answer, and no second effect.
#include "service/operations/commands.hpp"

#include <gmock/gmock.h>

#include "tests/service/daemon_fixture.hpp"

namespace reident::test::commands_test {
namespace {

using storage::Command;
using storage::CommandOutcome;
using storage::DecisionKind;
using testing::HasSubstr;
using enum DecisionKind;

class Commands : public DaemonTest {
 protected:
  storage::Database database_ = open();
  storage::Registry registry_{database_};
  storage::Time now_ = day;
  std::uint64_t requests_ = 0;
  CommandContext context_{{{"SAT", "PLANT"}, {"SAT", "PUMP"}}, {}};

  /// The next version of an equipment; the window ends at the minute given.
  std::int64_t version(DecisionKind kind, std::int64_t window_end = 0,
                       const std::string& spacecraft = "SAT",
                       const std::string& equipment = "PLANT") {
    storage::NewAttempt attempt;
    attempt.spacecraft = spacecraft;
    attempt.equipment = equipment;
    attempt.window = {day, day + window_end * minute};
    attempt.time = now_ += second;
    return registry_.record(attempt, {"{}", "digest"}, {kind, "gate", "figures"});
  }
  Command command(const std::string& action, std::int64_t version = 0) {
    return {"console", ++requests_, action, "SAT", "PLANT", version, "Ana", "training"};
  }
  CommandOutcome execute(const Command& command) {
    return reident::execute(command, registry_, context_, now_ += second);
  }
  CommandOutcome order(const std::string& action, std::int64_t version = 0) {
    return execute(command(action, version));
  }
  std::int64_t champion() const {
    const auto made = registry_.champion_decision("SAT", "PLANT");
    return made ? made->version : 0;
  }
  std::string status(std::int64_t number) const {
    return registry_.version("SAT", "PLANT", number)->status;
  }
  std::size_t rows() const {
    const storage::DecisionState state = registry_.decision_state("SAT", "PLANT");
    return static_cast<std::size_t>(state.last_decision + state.last_hold);
  }
  void expect_done(const CommandOutcome& outcome, const std::string& says) {
    EXPECT_TRUE(outcome.ok) << outcome.reply;
    EXPECT_THAT(outcome.reply, HasSubstr(says));
  }
  /// Refused with these words, and nothing was decided or held.
  void expect_refused(const Command& command, const std::vector<std::string>& words) {
    const std::size_t before = rows();
    const CommandOutcome outcome = execute(command);
    EXPECT_FALSE(outcome.ok);
    for (const std::string& word : words) EXPECT_THAT(outcome.reply, HasSubstr(word));
    EXPECT_EQ(rows(), before) << outcome.reply;
  }
};

TEST_F(Commands, an_approval_makes_the_waiting_version_champion) {
  version(wait);
  expect_done(order("approve", 1),
              "version 1 of SAT/PLANT is approved and champion now, the first");
  EXPECT_EQ(champion(), 1);
  const auto made = registry_.champion_decision("SAT", "PLANT");
  EXPECT_EQ(made->actor, "Ana");
  EXPECT_EQ(made->reason, "training");
  EXPECT_EQ(made->time, now_);
  version(wait);
  expect_done(order("approve", 2), "after version 1");
}

TEST_F(Commands, a_rejection_ends_the_wait) {
  version(wait);
  expect_done(order("reject", 1), "version 1 of SAT/PLANT is rejected");
  EXPECT_EQ(status(1), "rejected");
}

TEST_F(Commands, an_operator_without_a_name_decides_nothing) {
  version(wait);
  for (const std::string actor : {"", "a\nb"}) {
    Command nameless = command("approve", 1);
    nameless.actor = actor;
    expect_refused(nameless, {"the operator's name", "every decision names who made it"});
  }
  Command broken = command("approve", 1);
  broken.reason = "\xff";
  expect_refused(broken, {"the reason is not UTF-8"});
  broken = command("approve", 1);
  broken.reason.clear();
  expect_refused(broken, {"approve needs a reason"});
}

TEST_F(Commands, an_unknown_action_or_equipment_is_answered_with_those_there_are) {
  version(wait, 0, "OLD", "TANK");
  Command unknown = command("aprove", 1);
  expect_refused(unknown,
                 {"no action aprove", "approve, reject, roll_back, withdraw, hold, release, "});
  unknown = command("hold");
  unknown.equipment = "PLAN";
  expect_refused(unknown, {"no equipment SAT/PLAN", "known: OLD/TANK, SAT/PLANT, SAT/PUMP"});
}

TEST_F(Commands, a_spacecraft_that_is_left_out_is_the_only_one_with_the_equipment) {
  version(wait, 0, "OLD", "TANK");
  Command brief = command("approve", 1);
  brief.spacecraft.clear();
  brief.equipment = "TANK";
  expect_done(execute(brief), "version 1 of OLD/TANK is approved");
  version(wait, 0, "OLD", "PLANT");
  brief = command("hold");
  brief.spacecraft.clear();
  expect_refused(brief, {"PLANT is the name of several", "OLD/PLANT, SAT/PLANT"});
}

TEST_F(Commands, a_version_that_is_not_there_is_named_with_the_last_one) {
  for (const char* action : {"approve", "reject", "roll_back", "withdraw"})
    expect_refused(command(action, 7), {"SAT/PLANT has no version 7", "it has none yet"});
  version(wait);
  version(wait);
  for (const char* action : {"approve", "reject", "roll_back", "withdraw"})
    expect_refused(command(action, 7), {"SAT/PLANT has no version 7", "its last is 2"});
  for (const char* action : {"approve", "reject", "withdraw"})
    expect_refused(command(action), {"needs the number of a version"});
}

TEST_F(Commands, what_does_not_wait_is_told_with_who_decided_and_when) {
  version(approve);
  version(reject);
  version(approve);
  version(approve);
  order("withdraw", 4);
  for (const char* action : {"approve", "reject"}) {
    expect_refused(command(action, 1), {"is not waiting: it was approved by gate at 20",
                                        "version 3 is champion now (rolled back to by Ana at 20"});
    expect_refused(command(action, 2), {"it was rejected by gate at 20"});
    expect_refused(command(action, 3), {"it is the champion, rolled back to by Ana at 20"});
    expect_refused(command(action, 4), {"it was withdrawn by Ana at 20"});
  }
}

TEST_F(Commands, a_waiting_version_is_approved_whatever_the_champion_was_when_it_came) {
  version(wait, 10);
  version(approve, 20);
  expect_done(order("approve", 1), "approved and champion now, after version 2");
}

TEST_F(Commands, an_approval_answers_the_versions_that_waited_for_an_operator_before_it) {
  const auto ask_operator = [&](std::int64_t number) {
    registry_.decide("SAT", "PLANT", number,
                     {wait, "gate", "ask", R"({"reasons":[{"code":"bias_unverified"}]})"},
                     now_ += second);
  };
  for (int i = 0; i < 5; ++i) version(wait);
  for (const std::int64_t number : {1, 3, 4, 5}) ask_operator(number);
  version(wait, 0, "SAT", "PUMP");
  const CommandOutcome outcome = execute(command("approve", 4));
  EXPECT_TRUE(outcome.ok);
  EXPECT_THAT(outcome.reply,
              HasSubstr("; version 1, version 3 that waited before it are rejected"));
  const auto status = [&](std::int64_t number) {
    return registry_.version("SAT", "PLANT", number)->status;
  };
  EXPECT_EQ(status(1), "rejected");
  EXPECT_EQ(status(2), "waiting") << "it waits for telemetry";
  EXPECT_EQ(status(3), "rejected");
  EXPECT_EQ(status(4), "approved");
  EXPECT_EQ(status(5), "waiting") << "it came later";
  EXPECT_EQ(registry_.decisions("SAT", "PLANT", 3).back().actor, "Ana");
}

TEST_F(Commands, while_held_nothing_is_approved) {
  version(wait);
  order("hold");
  expect_refused(command("approve", 1),
                 {"SAT/PLANT is held by Ana since 20", "(training)", "release it first"});
  order("release");
  expect_done(order("approve", 1), "approved");
}

TEST_F(Commands, a_rollback_returns_to_the_previous_champion_and_reminds_of_the_next_window) {
  version(approve);
  version(approve);
  version(approve);
  expect_done(order("roll_back"),
              "SAT/PLANT is rolled back from version 3 to version 2; new windows go on and may "
              "replace it: 'reident hold SAT/PLANT' prevents it");
  order("hold");
  expect_done(order("roll_back"), "from version 2 to version 1 and stays held");
  EXPECT_EQ(champion(), 1);
  expect_refused(command("roll_back"),
                 {"SAT/PLANT cannot be rolled back: version 1, rolled back to "
                  "by Ana at 20",
                  "follows no champion that is left"});
  expect_done(order("roll_back", 3), "from version 1 to version 3");
}

TEST_F(Commands, a_rollback_needs_a_champion_and_a_version_that_was_one) {
  expect_refused(command("roll_back"), {"has no champion to roll back from"});
  version(approve);
  version(approve);
  version(reject);
  version(wait);
  version(approve);
  order("withdraw", 2);
  expect_refused(command("roll_back", 2),
                 {"cannot be rolled back to version 2: it was withdrawn by "
                  "Ana at"});
  expect_refused(command("roll_back", 3), {"it was rejected by gate", "and was never champion"});
  expect_refused(command("roll_back", 4),
                 {"it was left waiting by gate", "and was never champion"});
  expect_refused(command("roll_back", 5), {"it is the champion, approved by gate"});
  expect_done(order("roll_back"), "from version 5 to version 1");
}

TEST_F(Commands, a_rollback_is_possible_when_no_champion_is_left) {
  version(approve);
  version(approve);
  order("roll_back");
  order("withdraw", 1);
  EXPECT_EQ(champion(), 0);
  expect_refused(command("roll_back"), {"has no champion", "name the version"});
  expect_done(order("roll_back", 2), "SAT/PLANT is rolled back to version 2;");
  EXPECT_EQ(champion(), 2);
}

TEST_F(Commands, a_withdrawal_says_who_is_champion_then) {
  version(approve);
  version(approve);
  version(approve);
  expect_done(order("withdraw", 1),
              "version 1 of SAT/PLANT is withdrawn; version 3 is champion as "
              "before");
  expect_done(order("withdraw", 3), "version 2 is champion again");
  expect_refused(command("withdraw", 3), {"cannot be withdrawn: it was withdrawn by Ana at"});
  expect_done(order("withdraw", 2),
              "no champion is left: simulators that start now get none, those "
              "that run keep what they have");
  EXPECT_EQ(champion(), 0);
  version(reject);
  expect_refused(command("withdraw", 4), {"it was rejected by gate", "and was never champion"});
}

TEST_F(Commands, a_hold_and_a_release_each_count_once) {
  expect_refused(command("release"), {"SAT/PLANT is not held"});
  expect_done(order("hold"), "SAT/PLANT keeps no champion until 'reident release SAT/PLANT'");
  expect_refused(command("hold"), {"SAT/PLANT is held already by Ana since 20", "(training)"});
  expect_done(order("release"), "SAT/PLANT is released; it was held by Ana since 20");
  expect_refused(command("release"), {"SAT/PLANT is not held"});
  version(approve);
  expect_done(order("hold"), "keeps version 1 until");
}

TEST_F(Commands, a_window_is_asked_for_once_and_only_of_a_service) {
  expect_refused(command("identify_now"), {"no service runs", "reident backfill"});
  std::vector<std::string> asked;
  context_.ask_for_window = [&](const storage::EquipmentName& equipment,
                                const std::string& cause) -> std::optional<storage::Time> {
    asked.push_back(equipment.equipment + ": " + cause);
    if (equipment.equipment == "PUMP") return std::nullopt;
    return day;
  };
  const Command once = command("identify_now");
  expect_done(execute(once),
              "the window of SAT/PLANT that ends at 2022-01-08T00:00:00Z is due now");
  expect_done(execute(once), "is due now");
  EXPECT_THAT(asked, testing::ElementsAre("PLANT: asked by Ana"));
  Command without = command("identify_now");
  without.equipment = "PUMP";
  expect_refused(without, {"no telemetry of SAT/PUMP has come"});
}

TEST_F(Commands, of_two_operators_the_second_is_told_what_the_first_decided) {
  version(wait);
  Command first = command("approve", 1), second_one = command("reject", 1);
  second_one.requester = "other console";
  second_one.actor = "Bo";
  expect_done(execute(first), "approved");
  expect_refused(second_one, {"is not waiting: it is the champion, approved by Ana at 20"});
  EXPECT_EQ(champion(), 1);
}

TEST_F(Commands, a_command_repeated_after_a_lost_reply_gets_the_same_reply_and_no_second_effect) {
  version(approve);
  version(approve);
  version(approve);
  const Command once = command("roll_back");
  const CommandOutcome first = execute(once);
  const std::size_t before = rows();
  const CommandOutcome again = execute(once);
  EXPECT_TRUE(again.ok);
  EXPECT_EQ(again.reply, first.reply);
  EXPECT_EQ(champion(), 2);
  EXPECT_EQ(rows(), before);
  const Command too_early = command("approve", 4);
  const CommandOutcome refused = execute(too_early);
  EXPECT_FALSE(refused.ok);
  version(wait);
  EXPECT_EQ(execute(too_early).reply, refused.reply) << "what was answered stays answered";
  Command changed = once;
  changed.version = 3;
  expect_refused(changed, {"was another command (roll_back)"});
}

TEST_F(Commands, leadership_is_given_away_by_a_service_alone_and_the_command_is_kept) {
  Command order = command("switch_over");
  order.equipment.clear();
  expect_refused(order, {"no service runs"});
  context_.hand_over = [](const Command& one) { return CommandOutcome{true, "for " + one.actor}; };
  order.request = ++requests_;
  expect_done(execute(order), "for Ana");
  context_.hand_over = {};
  expect_done(execute(order), "for Ana");  // the same command, sent again
}

}  // namespace
}  // namespace reident::test::commands_test
