// Equal samples and options give equal bits, whatever runs the tasks and in which order.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "identification/search/identify.hpp"
#include "tests/support/same_bits.hpp"
#include "tests/support/systems.hpp"

namespace reident::identification::determinism_test {
namespace {

using Task = std::function<void(std::size_t)>;

void backwards(std::size_t count, const Task& task) {
  while (count > 0) task(--count);
}

ForEach shuffled(unsigned seed) {
  return [seed](std::size_t count, const Task& task) {
    std::vector<std::size_t> order(count);
    for (std::size_t i = 0; i < count; ++i) order[i] = i;
    std::mt19937 generator(seed);
    for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[generator() % i]);
    for (const std::size_t i : order) task(i);
  };
}

/// Each thread takes the next task that is left.
ForEach on_threads(unsigned threads) {
  return [threads](std::size_t count, const Task& task) {
    std::atomic<std::size_t> next = 0;
    std::vector<std::jthread> workers;
    for (unsigned t = 0; t < threads; ++t)
      workers.emplace_back([&] {
        for (std::size_t i = next++; i < count; i = next++) task(i);
      });
  };
}

struct Scenario {
  std::string name;
  Record record;
  IdentifyOptions options;
};

std::vector<Scenario> scenarios() {
  test::Noise noise(31);
  const StateSpaceModel truth = test::random_system(noise, 4, 2, 2);
  const Record noisy = test::with_gap(test::excited(truth, noise, 900, 0.1), 400, 430);
  std::vector<Scenario> all{{"noisy, with a gap", noisy, {}},
                            {"noise-free", test::excited(truth, noise, 700, 0), {}},
                            {"a budget for a few recipes", noisy, {}},
                            {"a given order", noisy, {}},
                            {"inputs that explain nothing", noisy, {}},
                            {"delays to be estimated", noisy, {}}};
  all[2].options.search_budget = 1e6;
  all[3].options.order = 4;
  all[4].record.y = noise.normal(noisy.rows(), 2);
  all[5].options.max_input_delay = 3;
  StateSpaceModel unstable = test::random_system(noise, 1, 1, 1);
  unstable.A(0, 0) = 1.002;
  all.push_back({"unstable on every fold", test::excited(unstable, noise, 900, 0), {}});
  all.back().options.order = 1;
  for (Scenario& scenario : all) scenario.options.max_order = 5;
  return all;
}

TEST(Determinism, NeitherTheOrderOfTheTasksNorTheThreadsChangeABit) {
  const std::vector<std::pair<std::string, ForEach>> runners{
      {"backwards", backwards},        {"shuffled 1", shuffled(1)},
      {"shuffled 2", shuffled(2)},     {"one thread", on_threads(1)},
      {"two threads", on_threads(2)},  {"four threads", on_threads(4)},
      {"eight threads", on_threads(8)}};
  for (const Scenario& scenario : scenarios()) {
    const IdentifyResult alone = identify(scenario.record, scenario.record.all(), scenario.options);
    for (const auto& [runner, for_each] : runners) {
      IdentifyOptions options = scenario.options;
      options.for_each = for_each;
      EXPECT_TRUE(test::same_bits(identify(scenario.record, scenario.record.all(), options), alone))
          << scenario.name << ", " << runner;
    }
  }
}

TEST(Determinism, WhereTheRecordStandsInMemoryChangesNoBit) {
  // Kernels that treated aligned and other columns differently would be seen here.
  test::Noise noise(32);
  const StateSpaceModel truth = test::random_system(noise, 3, 3, 1);
  const Record record = test::excited(truth, noise, 800, 0.1);
  const IdentifyResult alone = identify(record, record.all(), {});
  for (const Index before : {1, 2, 3, 5}) {
    Record later = record;
    later.u.conservativeResize(record.rows() + before, Eigen::NoChange);
    later.y.conservativeResize(record.rows() + before, Eigen::NoChange);
    later.u.bottomRows(record.rows()) = record.u;
    later.y.bottomRows(record.rows()) = record.y;
    later.u.topRows(before).setConstant(7);
    later.y.topRows(before).setConstant(-7);
    later.segments = {{0, later.rows(), -before}};
    EXPECT_TRUE(test::same_bits(identify(later, {before, later.rows()}, {}), alone)) << before;
  }
}

TEST(Determinism, TheComparisonSeesALastDigitOfOneSample) {
  test::Noise noise(33);
  const StateSpaceModel truth = test::random_system(noise, 2, 1, 1);
  Record record = test::excited(truth, noise, 600, 0.1);
  const IdentifyResult before = identify(record, record.all(), {});
  record.y(300, 0) = std::nextafter(record.y(300, 0), 1e9);
  EXPECT_FALSE(test::same_bits(identify(record, record.all(), {}), before));
}

}  // namespace
}  // namespace reident::identification::determinism_test
