// libreident-client as a simulator sees it: the shared library, over the real middleware.
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <reident/client.hpp>

#include "tests/service/client/live_telemetry.hpp"
#include "tests/service/dds/dds_fixture.hpp"
#include "tests/support/temporary_folder.hpp"

namespace reident::test::client_interface_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Kind = ClientEvent::Kind;

const std::vector<ClientSignal> inputs = {{"I_BDRIN1", "A"}, {"I_BDRIN2", "A"}};
const std::vector<ClientSignal> outputs = {{"I_BDROUT", "A"}};
const double nan = std::numeric_limits<double>::quiet_NaN();

ModelVersion version_of(std::int64_t number, const EquipmentModel& model) {
  ModelVersion version = example_version(number);
  version.model = model;
  version.digest = model_digest(model);
  return version;
}

class ClientInterface : public testing::Test {
 protected:
  ClientInterface() { open({}); }

  void open(std::optional<std::string> cache) {
    const dds::Endpoint endpoint = own_endpoint();
    ClientOptions options;
    options.simulator = "trainer";
    options.domain = endpoint.domain;
    options.partition = endpoint.partition;
    options.spacecraft = "CBERS*";
    options.cache_folder = cache ? *cache : "";
    client_.emplace(options);
  }
  /// The next event of the kind; the ones before it are gone.
  ClientEvent event(Kind kind) {
    for (int i = 0; i < 100; ++i) {
      const auto next = client_->next_event(10'000);
      if (!next) break;
      if (next->kind == kind) return *next;
    }
    ADD_FAILURE() << "no event of kind " << static_cast<int>(kind);
    return {};
  }
  /// Steps until the flags hold `flag`; returns the output.
  static double step_until(Runner& runner, int flag, const double* u) {
    double y = nan;
    EXPECT_TRUE(eventually([&] { return (runner.step(u, &y) & flag) != 0; }));
    return y;
  }

  dds::Participant service_{own_endpoint()};
  std::optional<dds::Writer<ModelVersion>> versions_{std::in_place, service_};
  dds::Reader<ModelAcknowledgement> acknowledgements_{service_};
  std::optional<Client> client_;
  static constexpr double u[] = {3.0, 1.5};
};

TEST_F(ClientInterface, RunsAVersionFromTheStepAfterItCameAndReportsIt) {
  Runner runner(*client_, "CBERS4", "BDR", inputs, outputs);
  double y = 0;
  EXPECT_EQ(runner.step(u, &y), REIDENT_NO_MODEL);
  EXPECT_TRUE(std::isnan(y));
  EXPECT_EQ(runner.state().version, 0);
  versions_->write(example_version(1));
  EXPECT_EQ(event(Kind::available).version, 1);
  EXPECT_EQ(step_until(runner, REIDENT_SWAPPED, u), 4.25 + 0.1 * 0.5);
  const ClientEvent swapped = event(Kind::swapped);
  EXPECT_EQ(swapped.version, 1);
  EXPECT_EQ(swapped.spacecraft + "/" + swapped.equipment, "CBERS4/BDR");
  EXPECT_GT(swapped.time_ns, swapped.published_ns);
  EXPECT_GT(swapped.published_ns, swapped.decided_ns);
  const double measured = 4.3;
  EXPECT_EQ(runner.follow(u, &measured, &y), 0) << "by the Kalman gain";
  const RunnerState state = runner.state();
  EXPECT_EQ(state.version, 1);
  EXPECT_EQ(state.following, 1);
  EXPECT_EQ(state.steps, 2U);
  EXPECT_EQ(state.sample_period_s, 1);
  EXPECT_GT(state.running_mrse_percent, 0);
  EXPECT_GT(state.age_ns, 0);
  std::optional<ModelAcknowledgement> told;
  EXPECT_TRUE(eventually([&] {
    for (auto& message : take_all(acknowledgements_, 1)) told = std::move(message);
    return told && told->running.version == 1;
  }));
  EXPECT_EQ(told->simulator, "trainer");
  EXPECT_EQ(told->running.mode, "free");
  EXPECT_EQ(told->running.since, swapped.time_ns);
}

TEST_F(ClientInterface, SaysOnceThatNobodyPublishesAnEquipmentAlsoWhereAVersionWasKept) {
  const TemporaryFolder folder;
  open(folder.path());
  EquipmentModel battery = example_model();
  battery.equipment = "BAT1";
  versions_->write(version_of(1, battery));
  event(Kind::available);
  client_.reset();
  versions_.emplace(service_);  // a service that knows no battery
  versions_->write(example_version(1));
  open(folder.path());
  Runner published(*client_, "CBERS4", "BDR", inputs, outputs);
  Runner kept(*client_, "CBERS4", "BAT1", inputs, outputs);
  Runner unknown(*client_, "CBERS4", "BRD", inputs, outputs);
  for (const std::string name : {"BAT1", "BRD"}) {
    const ClientEvent said = event(Kind::unpublished);
    EXPECT_EQ(said.equipment, name);
    EXPECT_THAT(said.text, HasSubstr("CBERS4/" + name));
  }
  while (const auto next = client_->next_event(100)) EXPECT_NE(next->kind, Kind::unpublished);
}

TEST_F(ClientInterface, SwapsInMidRunWithoutAJump) {
  versions_->write(example_version(1));
  event(Kind::available);
  Runner runner(*client_, "CBERS4", "BDR", inputs, outputs);
  double y = 0, last = 0;
  for (std::int64_t k = 0; k < 200; ++k) runner.step(example_input(k).data(), &y);
  EquipmentModel other = example_model();
  other.dynamics.B *= 1.2;
  other.dynamics.A(0, 0) = 0.91;
  versions_->write(version_of(2, other));
  event(Kind::available);
  std::int64_t k = 200;
  int flags = 0;
  double largest = 0;
  while (k < 210 && (flags & REIDENT_SWAPPED) == 0) {
    last = y;
    flags = runner.step(example_input(k++).data(), &y);
    largest = std::max(largest, std::abs(y - last));
  }
  EXPECT_LT(largest, 0.8) << "its own pace is up to 0.4 a step";
  ClientEvent second = event(Kind::swapped);
  if (second.version == 1) second = event(Kind::swapped);
  EXPECT_EQ(second.version, 2);
  EXPECT_EQ(second.matched_rows, 128);
  EXPECT_GT(second.remaining_step, 0.1);
  EXPECT_GE(second.transition_steps, 60);
  EXPECT_EQ(runner.state().transition_left, second.transition_steps - 1);
  EXPECT_EQ(runner.step(u, &y) & REIDENT_IN_TRANSITION, REIDENT_IN_TRANSITION);
}

TEST_F(ClientInterface, OffersAVersionOfOtherInputsAndTakesItWhenItIsAccepted) {
  std::vector<ClientSignal> more = inputs;
  more.push_back({"V_BUS", "V"});
  Runner runner(*client_, "CBERS4", "BDR", more, outputs);
  EXPECT_THROW(runner.accept(), ClientError);
  versions_->write(example_version(1));
  const double declared[] = {3.0, 1.5, 2.0};
  step_until(runner, REIDENT_SWAPPED, declared);
  EquipmentModel other = example_model();
  other.inputs[1] = {"P_IN", "W", -0.25, 4, "V_BUS * I_BDRIN2"};
  versions_->write(version_of(2, other));
  const ClientEvent offered = event(Kind::offered);
  EXPECT_EQ(offered.version, 2);
  EXPECT_THAT(offered.text, HasSubstr("others than those of version 1"));
  double y = 0;
  EXPECT_EQ(runner.step(declared, &y), 0);
  EXPECT_EQ(runner.state().version, 1);
  EXPECT_EQ(runner.state().offered_version, 2);
  runner.accept();
  EXPECT_EQ(runner.step(declared, &y) & REIDENT_SWAPPED, REIDENT_SWAPPED);
  EXPECT_EQ(runner.state().version, 2);
  EXPECT_EQ(runner.state().offered_version, 0);
}

TEST_F(ClientInterface, DoesNotRunAVersionWhoseSignalsAreNotDeclared) {
  struct Case {
    std::string equipment;
    std::vector<ClientSignal> inputs, outputs;
    std::string reason;
  };
  const std::vector<Case> cases = {
      {"BDR",
       {{"I_BDRIN1", ""}},
       outputs,
       "it needs I_BDRIN2, which the simulator does not declare"},
      {"BDR",
       {{"I_BDRIN1", "mA"}, {"I_BDRIN2", ""}},
       outputs,
       "its I_BDRIN1 is in A, and the simulator's in mA"},
      {"BDR", inputs, {{"V_BUS", ""}}, "it needs I_BDROUT, which the simulator does not declare"},
  };
  versions_->write(example_version(1));
  event(Kind::available);
  for (const Case& c : cases) {
    Runner runner(*client_, "CBERS4", c.equipment, c.inputs, c.outputs);
    EXPECT_THAT(event(Kind::offered).text, HasSubstr(c.reason));
    double y = 0;
    EXPECT_EQ(runner.step(u, &y), REIDENT_NO_MODEL);
    EXPECT_THROW(
        {
          try {
            runner.accept();
          } catch (const ClientError& error) {
            EXPECT_THAT(error.what(), HasSubstr(c.reason));
            throw;
          }
        },
        ClientError);
  }
}

TEST_F(ClientInterface, KeepsItsModelWhenAVersionMustNotRun) {
  Runner runner(*client_, "CBERS4", "BDR", inputs, outputs);
  versions_->write(example_version(3));
  step_until(runner, REIDENT_SWAPPED, u);
  ModelVersion damaged = example_version(4);
  damaged.digest[0] = damaged.digest[0] == 'a' ? 'b' : 'a';
  versions_->write(damaged);
  EXPECT_THAT(event(Kind::refused).text,
              HasSubstr("version 4 is refused: its content has the digest"));
  versions_->write(example_version(2));
  EXPECT_THAT(event(Kind::refused).text, HasSubstr("older than version 3 and not a rollback"));
  double y = 0;
  EXPECT_EQ(runner.step(u, &y), 0);
  EXPECT_EQ(runner.state().version, 3);
}

TEST_F(ClientInterface, StartsFromTheKeptVersionAndGoesOnWhenItIsConfirmed) {
  const std::string folder = testing::TempDir() + "client-cache-" + std::to_string(getpid());
  open(folder);
  versions_->write(example_version(7));
  event(Kind::available);
  client_.reset();
  versions_.reset();  // no service any more
  open(folder);
  const ClientEvent kept = event(Kind::available);
  EXPECT_TRUE(kept.from_cache);
  Runner runner(*client_, "CBERS4", "BDR", inputs, outputs);
  double y = 0;
  EXPECT_EQ(runner.step(u, &y), REIDENT_SWAPPED) << "at once";
  EXPECT_EQ(runner.state().from_cache, 1);
  EXPECT_GT(runner.state().age_ns, 0);
  versions_.emplace(service_);
  versions_->write(example_version(7));
  const ClientEvent confirmed = event(Kind::available);
  EXPECT_FALSE(confirmed.from_cache);
  EXPECT_THAT(confirmed.text, HasSubstr("is still the champion"));
  EXPECT_EQ(runner.state().from_cache, 0);
  EXPECT_EQ(runner.step(u, &y), 0) << "no swap";
  std::filesystem::remove_all(folder);
}

TEST_F(ClientInterface, SaysEachEventToTheCallbackOnItsOwnThread) {
  struct Heard {
    std::mutex mutex;
    std::vector<int> kinds;
  } heard;
  reident_on_event(
      client_->handle(),
      [](const reident_event* event, void* user) {
        auto* to = static_cast<Heard*>(user);
        const std::lock_guard lock(to->mutex);
        to->kinds.push_back(event->kind);
      },
      &heard);
  Runner runner(*client_, "CBERS4", "BDR", inputs, outputs);
  versions_->write(example_version(1));
  step_until(runner, REIDENT_SWAPPED, u);
  EXPECT_TRUE(eventually([&] {
    const std::lock_guard lock(heard.mutex);
    return heard.kinds.size() == 2;
  }));
  EXPECT_THAT(heard.kinds, ElementsAre(REIDENT_EVENT_AVAILABLE, REIDENT_EVENT_SWAPPED));
  reident_on_event(client_->handle(), nullptr, nullptr);
  versions_->write(example_version(2));
  EXPECT_EQ(event(Kind::available).version, 2);
}

TEST_F(ClientInterface, ShowsTheNewestVersionAsJson) {
  EXPECT_EQ(client_->version_json("CBERS4", "BDR"), std::nullopt);
  versions_->write(example_version(5));
  event(Kind::available);
  const auto json = nlohmann::json::parse(client_->version_json("CBERS4", "BDR").value());
  EXPECT_EQ(json["version"], 5);
  EXPECT_EQ(json["model"]["inputs"][0]["name"], "I_BDRIN1");
}

TEST_F(ClientInterface, RefusesWhatCanNeverBeDoneWithTheReason) {
  const auto said = [](auto&& call) -> std::string {
    try {
      call();
    } catch (const ClientError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said([&] {
              Runner(*client_, "CBERS4", "BDR", {{"a", ""}, {"a", ""}}, outputs);
            }),
            "a is declared twice");
  EXPECT_EQ(said([&] { Runner(*client_, "CBERS4", "BDR", inputs, {}); }), "no output is declared");
  Runner first(*client_, "CBERS4", "BDR", inputs, outputs);
  EXPECT_THAT(said([&] { Runner(*client_, "CBERS4", "BDR", inputs, outputs); }),
              HasSubstr("has a runner already"));
  EXPECT_EQ(said([&] { first.input_flags(2); }), "there is no input 2");
  ClientOptions options;
  options.domain = 231;
  EXPECT_THAT(said([&] { Client{options}; }), HasSubstr("the last one is 230"));
  EXPECT_EQ(reident_client_open(nullptr), nullptr);
  EXPECT_EQ(reident_next_event(client_->handle(), nullptr, 0), REIDENT_BAD_ARGUMENT);
  reident_client_close(nullptr);
  reident_runner_close(nullptr);
}

TEST_F(ClientInterface, FillsInNoMoreThanAnOlderCallersStructuresHave) {
  versions_->write(example_version(1));
  reident_event older;
  std::memset(&older, 0x55, sizeof older);
  older.size = offsetof(reident_event, version);
  ASSERT_TRUE(eventually([&] { return reident_next_event(client_->handle(), &older, 100) == 1; }));
  EXPECT_EQ(older.kind, REIDENT_EVENT_AVAILABLE);
  EXPECT_EQ(older.version, 0x5555555555555555);
}

// Run under TSan, this is the test of the hand-over.
TEST_F(ClientInterface, StepsOnWhileVersionsRain) {
  Runner runner(*client_, "CBERS4", "BDR", inputs, outputs);
  std::atomic<bool> done = false;
  std::uint64_t swaps = 0, wrong = 0;
  std::thread simulator([&] {
    double y = 0;
    for (std::int64_t k = 0; !done; ++k) {
      const double measured = 4.25;
      const identification::Vector now = example_input(k % 1000);
      const int flags =
          k % 100 < 50 ? runner.step(now.data(), &y) : runner.follow(now.data(), &measured, &y);
      if ((flags & REIDENT_SWAPPED) != 0) ++swaps;
      if ((flags & REIDENT_NO_MODEL) == 0 && !std::isfinite(y)) ++wrong;
    }
  });
  EquipmentModel model = example_model();
  for (std::int64_t number = 1; number <= 200; ++number) {
    model.dynamics.A(0, 0) = 0.9 + 0.0001 * static_cast<double>(number % 7);
    versions_->write(version_of(number, model));
  }
  EXPECT_TRUE(eventually([&] {
    const auto json = client_->version_json("CBERS4", "BDR");
    return json && nlohmann::json::parse(*json)["version"] == 200;
  }));
  std::int64_t last = 0;
  while (last < 200) {
    const auto next = client_->next_event(10'000);
    if (!next) break;
    if (next->kind != Kind::swapped) continue;
    EXPECT_GT(next->version, last) << "in order";
    last = next->version;
  }
  done = true;
  simulator.join();
  EXPECT_EQ(last, 200);
  EXPECT_GT(swaps, 0U);
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(runner.state().version, 200);
}

}  // namespace
}  // namespace reident::test::client_interface_test
