// Who leads: of two services, at every moment one at most that has heard of the other.
#include "service/daemon/leadership_rule.hpp"

#include <gtest/gtest.h>

namespace reident::test::leadership_rule_test {
namespace {

using namespace std::chrono_literals;
using Role = LeadershipRule::Role;
using Step = LeadershipRule::Step;

class LeadershipRuleTest : public testing::Test {
 protected:
  Instant now_ = 100s;
  Standing ours_{4, 10, 1};
  LeadershipRule rule_{1, now_};

  /// Looks until `time` has passed or something is to be done; returns that.
  Step look_for(Instant time) {
    for (const Instant until = now_ + time; now_ < until; now_ += 50ms)
      if (const Step step = rule_.look(ours_, now_); step != Step::none) return step;
    return Step::none;
  }
  void hear_leader(std::int64_t term = 4, bool is_handed_over = false) {
    rule_.hear_leader(term, "other", is_handed_over, now_);
  }
  void follow() {
    hear_leader();
    EXPECT_EQ(look_for(100ms), Step::none);
    EXPECT_EQ(rule_.role(), Role::follows);
  }
  void lead() {
    EXPECT_EQ(look_for(3s), Step::take_over);
    rule_.took_over(rule_.next_term(ours_.term));
  }
};

TEST_F(LeadershipRuleTest, OneThatHearsNobodyLeadsAfterAWhile) {
  EXPECT_EQ(look_for(LeadershipRule::start_wait), Step::none);
  EXPECT_EQ(look_for(100ms), Step::take_over);
  EXPECT_EQ(look_for(100ms), Step::take_over) << "until it is done";
  EXPECT_EQ(rule_.next_term(4), 5);
  rule_.took_over(5);
  EXPECT_EQ(rule_.role(), Role::leads);
  EXPECT_EQ(look_for(1min), Step::none);
}

TEST_F(LeadershipRuleTest, OneThatNobodyHearsNeitherLeadsNorTakesOver) {
  follow();
  for (const Instant until = now_ + 1min; now_ < until; now_ += 50ms)
    EXPECT_EQ(rule_.look_while_unheard(now_), Step::none);
  EXPECT_EQ(rule_.leader(), "");
  EXPECT_EQ(look_for(5s), Step::none) << "it joins again, and finds the leader";
  follow();
  EXPECT_EQ(look_for(LeadershipRule::lease / 2), Step::none);
  lead();
  EXPECT_EQ(rule_.look_while_unheard(now_), Step::step_down);
  EXPECT_EQ(rule_.role(), Role::listens);
  EXPECT_EQ(rule_.look_while_unheard(now_), Step::none);
}

TEST_F(LeadershipRuleTest, OfTwoThatStartTheOneThatGoesFurtherLeads) {
  const auto first_step = [&](const Standing& partner) {
    LeadershipRule rule(1, now_);
    rule.hear_partner(partner, now_);
    return rule.look(ours_, now_);
  };
  EXPECT_EQ(first_step({4, 9, 2}), Step::take_over);
  EXPECT_EQ(first_step({4, 10, 2}), Step::none) << "the strength decides between equals";
  EXPECT_EQ(first_step({4, 11, 2}), Step::none);
  EXPECT_EQ(first_step({6, 1, 2}), Step::none);
  EXPECT_EQ(first_step({2, 99, 2}), Step::take_over) << "a later term goes further";
}

TEST_F(LeadershipRuleTest, WhoWaitsForAPartnerThatDoesNotLeadDoesSoInTheEnd) {
  const auto hear = [&] { rule_.hear_partner({4, 12, 2}, now_); };
  Step step = Step::none;
  const Instant start = now_;
  while (step == Step::none) hear(), step = look_for(500ms);
  EXPECT_EQ(step, Step::take_over);
  EXPECT_GE(now_ - start, LeadershipRule::start_wait + LeadershipRule::patience);
}

TEST_F(LeadershipRuleTest, AFollowerTakesOverWhenTheLeaseHasPassed) {
  follow();
  EXPECT_EQ(rule_.leader(), "other");
  hear_leader();
  const Instant heard = now_;
  EXPECT_EQ(look_for(5s), Step::take_over);
  EXPECT_GT(now_ - heard, LeadershipRule::lease);
  EXPECT_LE(now_ - heard, LeadershipRule::lease + 100ms);
  EXPECT_EQ(rule_.leader(), "");
}

TEST_F(LeadershipRuleTest, AFollowerTakesOverAtOnceWhereTheMiddlewareKnowsThatNobodyLeads) {
  follow();
  rule_.hear_end();
  EXPECT_EQ(look_for(100ms), Step::take_over);
}

TEST_F(LeadershipRuleTest, AFollowerThatWasAwayBelievesNoSilence) {
  follow();
  now_ += 3s;
  rule_.hear_end();  // its middleware was away as well
  EXPECT_EQ(look_for(900ms), Step::none);
  EXPECT_EQ(rule_.role(), Role::follows);
  now_ += 20s;
  EXPECT_EQ(look_for(LeadershipRule::absence_wait), Step::none);
  hear_leader();
  EXPECT_EQ(look_for(100ms), Step::none);
  EXPECT_EQ(rule_.role(), Role::follows);
}

TEST_F(LeadershipRuleTest, ALeaderThatWasAwayLeadsNoMoreUntilItKnowsThatNobodyElseDoes) {
  lead();
  now_ += 900ms;
  EXPECT_EQ(look_for(100ms), Step::none);
  now_ += 1500ms;
  EXPECT_EQ(look_for(100ms), Step::step_down);
  EXPECT_EQ(rule_.role(), Role::listens);
  EXPECT_EQ(look_for(LeadershipRule::start_wait - 100ms), Step::none);
  EXPECT_EQ(look_for(500ms), Step::take_over);
  rule_.took_over(7);
  now_ += 1min;
  EXPECT_EQ(look_for(100ms), Step::step_down);
  EXPECT_EQ(look_for(10s), Step::none);
  hear_leader(8);
  EXPECT_EQ(look_for(100ms), Step::none);
  EXPECT_EQ(rule_.role(), Role::follows);
}

TEST_F(LeadershipRuleTest, OfTwoLeadersTheLaterTermWins) {
  lead();
  hear_leader(4);
  EXPECT_EQ(look_for(100ms), Step::none);
  EXPECT_EQ(rule_.role(), Role::leads);
  hear_leader(6);
  EXPECT_EQ(look_for(100ms), Step::step_down);
  EXPECT_EQ(rule_.role(), Role::follows);
}

TEST_F(LeadershipRuleTest, ALeaderThatDoesNotKnowTheLastTermIsNotFollowed) {
  ours_.term = 6;
  hear_leader(4);
  EXPECT_EQ(look_for(LeadershipRule::start_wait), Step::none);
  hear_leader(4);
  EXPECT_EQ(look_for(100ms), Step::take_over);
}

TEST_F(LeadershipRuleTest, TheOneThatIsNamedTakesOverAlthoughTheOtherGoesAsFar) {
  follow();
  rule_.hear_partner({4, 10, 2}, now_);
  hear_leader(4, true);
  EXPECT_EQ(look_for(100ms), Step::take_over);
}

TEST_F(LeadershipRuleTest, WhoGaveLeadershipAwayLeadsAgainOnlyIfNobodyTakesIt) {
  lead();
  rule_.hand_over(now_);
  rule_.hear_partner({4, 9, 2}, now_);
  EXPECT_EQ(look_for(LeadershipRule::patience), Step::none);
  EXPECT_EQ(look_for(200ms), Step::take_over);
}

TEST(LeadershipTerms, OfTheTwoNeverShareANumber) {
  LeadershipRule one(1, {}), two(2, {});
  for (std::int64_t last = 0; last < 9; ++last) {
    EXPECT_EQ(one.next_term(last) % 2, 1);
    EXPECT_EQ(two.next_term(last) % 2, 0);
    EXPECT_GT(one.next_term(last), last);
    EXPECT_GT(two.next_term(last), last);
  }
  one.hear_leader(10, "two", false, {});
  EXPECT_EQ(one.next_term(3), 11);
}

}  // namespace
}  // namespace reident::test::leadership_rule_test
