// Versions over the real middleware: what is handed over, what is refused, what is said about it.
#include "service/client/model_subscriber.hpp"

#include <memory>
#include <optional>

#include <gmock/gmock.h>

#include "tests/service/dds/dds_fixture.hpp"
#include "tests/service/model/example_model.hpp"

namespace reident::test {
namespace {

class Subscriber : public testing::Test {
 protected:
  Subscriber() { subscribe(); }

  void subscribe() {
    subscriber_.emplace(simulator_, Subscription{"trainer", "CBERS4", {"BDR", "MEA"}});
  }
  /// Polls until so many versions were adopted or refused since the test began.
  bool heard(std::size_t adopted, std::size_t refused) {
    return eventually([&] {
      subscriber_->poll(
          [&](const ModelVersion& version) { adopted_.push_back(version.number); },
          [&](const ModelSubscriber::Refusal& refusal) { refused_.push_back(refusal); });
      return adopted_.size() >= adopted && refused_.size() >= refused;
    });
  }
  ModelAcknowledgement next_acknowledgement() { return take_all(acknowledgements_, 1).at(0); }

  dds::Participant service_{own_endpoint()};
  dds::Participant simulator_{own_endpoint()};
  std::optional<dds::Writer<ModelVersion>> versions_{std::in_place, service_};
  dds::Reader<ModelAcknowledgement> acknowledgements_{service_};
  std::optional<ModelSubscriber> subscriber_;
  std::vector<std::int64_t> adopted_;
  std::vector<ModelSubscriber::Refusal> refused_;
};

TEST_F(Subscriber, that_starts_late_gets_the_champion_and_then_each_new_version) {
  versions_->write(example_version(1));
  versions_->write(example_version(2));
  subscribe();
  ASSERT_TRUE(heard(1, 0));
  versions_->write(example_version(3));
  ASSERT_TRUE(heard(2, 0));
  EXPECT_THAT(adopted_, testing::ElementsAre(2, 3));
  EXPECT_EQ(subscriber_->in_use("BDR")->number, 3);
  EXPECT_EQ(subscriber_->in_use("MEA"), nullptr);
}

TEST_F(Subscriber, does_not_swap_when_a_restarted_service_publishes_the_champion_again) {
  versions_->write(example_version(2));
  ASSERT_TRUE(heard(1, 0));
  versions_.reset();
  ASSERT_TRUE(heard(1, 0));
  EXPECT_EQ(subscriber_->in_use("BDR")->number, 2) << "the end of the service took it away";
  versions_.emplace(service_);
  versions_->write(example_version(2));
  ModelVersion marker = example_version(1);
  marker.model.equipment = "MEA";
  marker.digest = model_digest(marker.model);
  versions_->write(marker);
  ASSERT_TRUE(heard(2, 0));
  EXPECT_THAT(adopted_, testing::ElementsAre(2, 1)) << "version 2 of BDR, then the marker";
  EXPECT_THAT(refused_, testing::IsEmpty());
}

TEST_F(Subscriber, refuses_an_older_version_unless_it_is_a_rollback) {
  versions_->write(example_version(5));
  ASSERT_TRUE(heard(1, 0));
  versions_->write(example_version(3));
  ASSERT_TRUE(heard(1, 1));
  EXPECT_THAT(refused_[0].reason, testing::HasSubstr("older than version 5"));
  EXPECT_EQ(subscriber_->in_use("BDR")->number, 5);
  ModelVersion rollback = example_version(3);
  rollback.rollback = true;
  versions_->write(rollback);
  ASSERT_TRUE(heard(2, 1));
  EXPECT_EQ(subscriber_->in_use("BDR")->number, 3);
}

TEST_F(Subscriber, keeps_the_good_version_when_a_damaged_one_comes_and_says_so) {
  versions_->write(example_version(1));
  ASSERT_TRUE(heard(1, 0));
  ModelVersion damaged = example_version(2);
  damaged.model.dynamics.A(0, 0) += 0.01;
  versions_->write(damaged);
  ASSERT_TRUE(heard(1, 1));
  EXPECT_EQ(subscriber_->in_use("BDR")->number, 1);
  const ModelAcknowledgement answer = next_acknowledgement();
  EXPECT_FALSE(answer.accepted);
  EXPECT_EQ(answer.version, 2);
  EXPECT_EQ(answer.equipment, "BDR");
  EXPECT_THAT(answer.reason, testing::HasSubstr("digest"));
}

TEST_F(Subscriber, refuses_with_an_answer_what_the_middleware_could_hardly_decode) {
  ModelVersion torn = example_version(2);
  torn.model.dynamics.B.conservativeResize(2, 1);
  versions_->write(torn);
  ASSERT_TRUE(heard(0, 1));
  EXPECT_EQ(refused_[0].version, 2);
  EXPECT_THAT(next_acknowledgement().reason, testing::HasSubstr("B has 2 numbers; 2 x 2"));
}

TEST_F(Subscriber, tells_two_services_that_publish_different_models_of_one_number) {
  versions_->write(example_version(1));
  ASSERT_TRUE(heard(1, 0));
  ModelVersion rival = example_version(1);
  rival.model.dynamics.D(0, 0) = 0.3;
  rival.digest = model_digest(rival.model);
  dds::Writer<ModelVersion> other(service_);
  other.write(rival);
  ASSERT_TRUE(heard(1, 1));
  EXPECT_THAT(refused_[0].reason, testing::HasSubstr("two services"));
}

TEST_F(Subscriber, passes_over_other_spacecraft_and_equipment) {
  ModelVersion other = example_version(1);
  other.model.spacecraft = "CBERS4A";
  versions_->write(other);
  other = example_version(1);
  other.model.equipment = "BAT1";
  versions_->write(other);
  versions_->write(example_version(7));
  ASSERT_TRUE(heard(1, 0));
  EXPECT_THAT(adopted_, testing::ElementsAre(7));
  EXPECT_THAT(refused_, testing::IsEmpty());
}

TEST_F(Subscriber, acknowledges_what_runs_also_to_a_service_that_starts_later) {
  versions_->write(example_version(4));
  ASSERT_TRUE(heard(1, 0));
  subscriber_->acknowledge("BDR", 123, 2.5);
  subscriber_->acknowledge("BAT1", 1, 1);  // nothing runs, nothing is said
  dds::Reader<ModelAcknowledgement> late(service_);
  const ModelAcknowledgement answer = take_all(late, 1).at(0);
  EXPECT_EQ(answer.simulator, "trainer");
  EXPECT_EQ(answer.version, 4);
  EXPECT_EQ(answer.digest, example_version(4).digest);
  EXPECT_TRUE(answer.accepted);
  EXPECT_EQ(answer.since, 123);
  EXPECT_EQ(answer.running_mrse_percent, 2.5);
  EXPECT_EQ(late.take(10, [](ModelAcknowledgement&&) {}), 0U);
}

}  // namespace
}  // namespace reident::test
