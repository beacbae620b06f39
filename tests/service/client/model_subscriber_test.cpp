// Versions over the real middleware: what is handed over, what is refused, what is said about it.
#include "service/client/model_subscriber.hpp"

#include <filesystem>
#include <optional>

#include <gmock/gmock.h>

#include "service/support/utc_clock.hpp"
#include "tests/service/dds/dds_fixture.hpp"
#include "tests/service/model/example_model.hpp"

namespace reident::test::model_subscriber_test {
namespace {

class Subscriber : public testing::Test {
 protected:
  Subscriber() { subscribe(); }

  void subscribe(std::optional<ModelCache> cache = std::nullopt) {
    subscribe({"trainer", "CBERS4", {"BDR", "MEA"}}, std::move(cache));
  }
  void subscribe(const Subscription& subscription, std::optional<ModelCache> cache = std::nullopt) {
    subscriber_.emplace(simulator_, subscription, std::move(cache));
  }
  /// Polls until so many versions were adopted or refused since the test began.
  bool heard(std::size_t adopted, std::size_t refused) {
    return eventually([&] {
      subscriber_->poll(listener_);
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
  std::vector<Arrival> arrivals_;
  std::vector<ModelSubscriber::Refusal> refused_;
  std::vector<std::int64_t> confirmed_;
  const ModelSubscriber::Listener listener_{
      .adopt =
          [this](const ModelVersion& version, const Arrival& arrival) {
            adopted_.push_back(version.number);
            arrivals_.push_back(arrival);
          },
      .refuse = [this](const ModelSubscriber::Refusal& refusal) { refused_.push_back(refusal); },
      .confirm = [this](const ModelVersion& version,
                        const Arrival&) { confirmed_.push_back(version.number); },
      .cache_fault = [](const CacheFault& fault) { ADD_FAILURE() << fault.reason; },
  };
  static inline const storage::EquipmentName bdr{"CBERS4", "BDR"};
  static inline const storage::EquipmentName mea{"CBERS4", "MEA"};
};

TEST_F(Subscriber, ThatStartsLateGetsTheChampionAndThenEachNewVersion) {
  versions_->write(example_version(1));
  versions_->write(example_version(2));
  subscribe();
  ASSERT_TRUE(heard(1, 0));
  versions_->write(example_version(3));
  ASSERT_TRUE(heard(2, 0));
  EXPECT_THAT(adopted_, testing::ElementsAre(2, 3));
  EXPECT_EQ(subscriber_->newest(bdr)->version.number, 3);
  EXPECT_EQ(subscriber_->newest(mea), nullptr);
}

TEST_F(Subscriber, LearnsWhenAVersionWasSent) {
  const storage::Time before = utc_now();
  versions_->write(example_version(1));
  const storage::Time after = utc_now();
  ASSERT_TRUE(heard(1, 0));
  EXPECT_GE(arrivals_[0].published, before);
  EXPECT_LE(arrivals_[0].published, after);
  EXPECT_GE(arrivals_[0].received, arrivals_[0].published);
  EXPECT_FALSE(arrivals_[0].from_cache);
}

TEST_F(Subscriber, DoesNotSwapWhenARestartedServicePublishesTheChampionAgain) {
  versions_->write(example_version(2));
  ASSERT_TRUE(heard(1, 0));
  versions_.reset();
  ASSERT_TRUE(heard(1, 0));
  EXPECT_EQ(subscriber_->newest(bdr)->version.number, 2) << "the end of the service took it away";
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

TEST_F(Subscriber, RefusesAnOlderVersionUnlessItIsARollback) {
  versions_->write(example_version(5));
  ASSERT_TRUE(heard(1, 0));
  versions_->write(example_version(3));
  ASSERT_TRUE(heard(1, 1));
  EXPECT_THAT(refused_[0].reason, testing::HasSubstr("older than version 5"));
  EXPECT_EQ(subscriber_->newest(bdr)->version.number, 5);
  ModelVersion rollback = example_version(3);
  rollback.rollback = true;
  versions_->write(rollback);
  ASSERT_TRUE(heard(2, 1));
  EXPECT_EQ(subscriber_->newest(bdr)->version.number, 3);
}

TEST_F(Subscriber, KeepsTheGoodVersionWhenADamagedOneComesAndSaysSo) {
  versions_->write(example_version(1));
  ASSERT_TRUE(heard(1, 0));
  ModelVersion damaged = example_version(2);
  damaged.model.dynamics.A(0, 0) += 0.01;
  versions_->write(damaged);
  ASSERT_TRUE(heard(1, 1));
  EXPECT_EQ(subscriber_->newest(bdr)->version.number, 1);
  const ModelAcknowledgement answer = next_acknowledgement();
  EXPECT_FALSE(answer.accepted);
  EXPECT_EQ(answer.version, 2);
  EXPECT_EQ(answer.equipment, "BDR");
  EXPECT_THAT(answer.reason, testing::HasSubstr("digest"));
}

TEST_F(Subscriber, RefusesWithAnAnswerWhatTheMiddlewareCouldHardlyDecode) {
  ModelVersion torn = example_version(2);
  torn.model.dynamics.B.conservativeResize(2, 1);
  versions_->write(torn);
  ASSERT_TRUE(heard(0, 1));
  EXPECT_EQ(refused_[0].version, 2);
  EXPECT_THAT(next_acknowledgement().reason, testing::HasSubstr("B has 2 numbers; 2 x 2"));
}

TEST_F(Subscriber, TellsTwoServicesThatPublishDifferentModelsOfOneNumber) {
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

TEST_F(Subscriber, PassesOverOtherSpacecraftAndEquipment) {
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

TEST_F(Subscriber, HearsOfEverySpacecraftAndEquipmentThatItsPatternsName) {
  subscribe({"trainer", "CBERS*", {"B?R", "MEA"}});
  std::int64_t number = 0;
  for (const auto& [spacecraft, equipment] : std::vector<std::pair<std::string, std::string>>{
           {"CBERS4", "BDR"}, {"CBERS4", "BAT1"}, {"AMAZONIA1", "BDR"}, {"CBERS4A", "BDR"}}) {
    ModelVersion version = example_version(++number);
    version.model.spacecraft = spacecraft;
    version.model.equipment = equipment;
    version.digest = model_digest(version.model);
    versions_->write(version);
  }
  ASSERT_TRUE(heard(2, 0));
  EXPECT_THAT(adopted_, testing::ElementsAre(1, 4));
  EXPECT_EQ(subscriber_->newest(bdr)->version.number, 1);
  EXPECT_EQ(subscriber_->newest({"CBERS4A", "BDR"})->version.number, 4);
}

RunningModel running(std::int64_t version, storage::Time since) {
  RunningModel model;
  model.version = version;
  model.mode = "free";
  model.since = since;
  model.mrse_percent = 2.5;
  return model;
}

TEST_F(Subscriber, AcknowledgesWhatRunsAlsoToAServiceThatStartsLater) {
  versions_->write(example_version(4));
  ASSERT_TRUE(heard(1, 0));
  subscriber_->acknowledge(bdr, running(4, 123));
  dds::Reader<ModelAcknowledgement> late(service_);
  const ModelAcknowledgement answer = take_all(late, 1).at(0);
  EXPECT_EQ(answer.simulator, "trainer");
  EXPECT_EQ(answer.spacecraft, "CBERS4");
  EXPECT_EQ(answer.version, 4);
  EXPECT_EQ(answer.digest, example_version(4).digest);
  EXPECT_TRUE(answer.accepted);
  EXPECT_EQ(answer.running, running(4, 123));
  EXPECT_EQ(answer.process, static_cast<std::uint64_t>(getpid()));
  EXPECT_NE(answer.host, "");
  EXPECT_NE(answer.program_version, "");
  EXPECT_EQ(late.take(10, [](ModelAcknowledgement&&) {}), 0U);
}

TEST_F(Subscriber, TellsARefusalBesideWhatRunsUntilAGoodVersionComes) {
  versions_->write(example_version(4));
  ASSERT_TRUE(heard(1, 0));
  subscriber_->acknowledge(bdr, running(4, 123));
  versions_->write(example_version(3));
  ASSERT_TRUE(heard(1, 1));
  subscriber_->acknowledge(bdr, running(4, 123));
  ModelAcknowledgement answer = take_all(acknowledgements_, 1).back();
  EXPECT_FALSE(answer.accepted);
  EXPECT_EQ(answer.version, 3);
  EXPECT_EQ(answer.running, running(4, 123));
  versions_->write(example_version(5));
  ASSERT_TRUE(heard(2, 1));
  answer = take_all(acknowledgements_, 1).back();
  EXPECT_TRUE(answer.accepted) << answer.reason;
  EXPECT_EQ(answer.version, 4) << "until the caller says that the new one runs";
  EXPECT_EQ(answer.digest, example_version(4).digest);
}

class SubscriberWithCache : public Subscriber {
 protected:
  SubscriberWithCache() { std::filesystem::remove_all(folder_); }
  ~SubscriberWithCache() override { std::filesystem::remove_all(folder_); }
  ModelCache cache() const { return {folder_, "test"}; }
  void keep(std::int64_t number) const {
    cache().store({example_version(number), 7, 8}, listener_.cache_fault);
  }
  std::int64_t kept() const {
    const auto versions = cache().load(listener_.cache_fault);
    return versions.empty() ? 0 : versions[0].version.number;
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("subscriber-test-" + std::to_string(getpid()));
};

TEST_F(SubscriberWithCache, HandsOutWhatWasKeptAtOnceAndWhatIsPublishedSucceedsIt) {
  keep(4);
  subscribe(cache());
  EXPECT_EQ(subscriber_->poll(listener_), 1U) << "no service was ever heard";
  EXPECT_THAT(adopted_, testing::ElementsAre(4));
  EXPECT_TRUE(arrivals_[0].from_cache);
  EXPECT_EQ(arrivals_[0].published, 7);
  EXPECT_EQ(arrivals_[0].received, 8);
  versions_->write(example_version(5));
  ASSERT_TRUE(heard(2, 0));
  EXPECT_FALSE(arrivals_[1].from_cache);
  EXPECT_EQ(kept(), 5);
}

TEST_F(SubscriberWithCache, HandsOutNothingThatItDidNotSubscribeTo) {
  keep(4);
  subscribe({"trainer", "CBERS4", {"MEA"}}, cache());
  EXPECT_EQ(subscriber_->poll(listener_), 0U);
}

TEST_F(SubscriberWithCache, SaysWhenTheServiceConfirmsWhatWasKept) {
  keep(4);
  subscribe(cache());
  versions_->write(example_version(4));
  ASSERT_TRUE(eventually([&] {
    subscriber_->poll(listener_);
    return !confirmed_.empty();
  }));
  EXPECT_THAT(adopted_, testing::ElementsAre(4));
  EXPECT_FALSE(subscriber_->newest(bdr)->arrival.from_cache);
}

TEST_F(SubscriberWithCache, RefusesAnOlderVersionThanWasKeptAndNamesTheFile) {
  keep(6);
  subscribe(cache());
  versions_->write(example_version(4));
  ASSERT_TRUE(heard(1, 1));
  EXPECT_THAT(refused_[0].reason, testing::HasSubstr("older than version 6"));
  EXPECT_THAT(refused_[0].reason, testing::HasSubstr(cache().file_of(bdr).string()));
  EXPECT_EQ(kept(), 6);
  ModelVersion back = example_version(4);
  back.rollback = true;
  versions_->write(back);
  ASSERT_TRUE(heard(2, 1));
  EXPECT_EQ(kept(), 4);
}

TEST_F(SubscriberWithCache, KeepsAVersionOnlyAfterItWasHandedOver) {
  subscribe(cache());
  std::int64_t kept_at_adoption = -1;
  ModelSubscriber::Listener listener = listener_;
  listener.adopt = [&](const ModelVersion&, const Arrival&) { kept_at_adoption = kept(); };
  versions_->write(example_version(2));
  ASSERT_TRUE(eventually([&] { return subscriber_->poll(listener) == 1; }));
  EXPECT_EQ(kept_at_adoption, 0);
  EXPECT_EQ(kept(), 2);
}

}  // namespace
}  // namespace reident::test::model_subscriber_test
