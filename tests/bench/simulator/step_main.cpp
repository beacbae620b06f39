// The step of an order-6, 4-in, 1-out model through the C interface: its time compared with the
// bare products of the same matrices, in turns, and what it allocates and asks of the system, with
// swaps in between. Prints one JSON object.
//   reident_step_bench REPETITIONS STEPS SWAPS
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>
#include <reident/client.hpp>

#include "service/dds/dds.hpp"
#include "service/model/model_json.hpp"
#include "tests/bench/simulator/handwritten.hpp"
#include "tests/bench/simulator/watched_thread.hpp"
#include "tests/support/systems.hpp"

namespace reident::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int inputs = 4;
constexpr std::size_t input_rows = 1024;

struct Versions {
  Versions() {
    test::Noise noise(6);
    model.spacecraft = "BENCH";
    model.equipment = "STEP";
    for (int i = 0; i < inputs; ++i) model.inputs.push_back({fmt::format("U{}", i), "A", -1, 1});
    model.outputs = {{"Y", "V", -100, 100}};
    model.dynamics = test::random_system(noise, 6, inputs, 1, 0.95);
    model.dynamics.period_s = 1;
    model.sample_hold_ns = 1'000'000'000;
    model.validation.mrse_percent = identification::Vector::Constant(1, 5);
    model.validation.fit_percent = identification::Vector::Constant(1, 80);
  }
  /// Every other version has other gains.
  ModelVersion make(std::int64_t number) const {
    ModelVersion version;
    version.model = model;
    if (number % 2 == 0) version.model.dynamics.C *= 1.1;
    version.number = number;
    version.digest = model_digest(version.model);
    version.decided = number;
    version.decided_by = "gate";
    return version;
  }
  EquipmentModel model;
};

std::vector<double> smooth_inputs() {
  std::vector<double> u;
  for (std::size_t k = 0; k < input_rows; ++k)
    for (int i = 0; i < inputs; ++i)
      u.push_back(std::sin(2 * M_PI * (i + 1) * static_cast<double>(k) / input_rows));
  return u;
}

double median(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Nanoseconds a step, over `steps` steps; the outputs' sum goes where nobody can leave it out.
template <class Step>
double time_steps(const std::vector<double>& u, std::size_t steps, Step&& step) {
  double sum = 0;
  const auto begin = Clock::now();
  for (std::size_t k = 0; k < steps; ++k) sum += step(&u[inputs * (k % input_rows)]);
  const std::chrono::duration<double, std::nano> took = Clock::now() - begin;
  volatile double sink = sum;
  static_cast<void>(sink);
  return took.count() / static_cast<double>(steps);
}

class Bench {
 public:
  Bench() {
    std::vector<ClientSignal> signals;
    for (const Signal& signal : versions_.model.inputs)
      signals.push_back({signal.name, signal.unit});
    ClientOptions options;
    options.domain = endpoint_.domain;
    options.partition = endpoint_.partition;
    options.cache_folder = "";
    client_.emplace(options);
    runner_.emplace(*client_, "BENCH", "STEP", signals, std::vector<ClientSignal>{{"Y", "V"}});
    writer_.write(versions_.make(++published_));
    double y = 0;
    while ((runner_->step(u_.data(), &y) & REIDENT_SWAPPED) == 0)
      if (const auto event = client_->next_event(1))
        if (event->kind == ClientEvent::Kind::refused) throw ClientError(event->text);
  }

  std::string times(std::size_t repetitions) {
    constexpr std::size_t steps = 20'000;
    Handwritten loop(versions_.model.dynamics);
    std::vector<double> runner_ns, loop_ns;
    for (std::size_t i = 0; i < repetitions; ++i) {
      runner_ns.push_back(time_steps(u_, steps, [this](const double* u) {
        double y = 0;
        runner_->step(u, &y);
        return y;
      }));
      loop_ns.push_back(time_steps(u_, steps, [&](const double* u) { return loop.step(u); }));
    }
    return fmt::format("\"step_ns\": {:.2f}, \"handwritten_ns\": {:.2f}", median(runner_ns),
                       median(loop_ns));
  }

  /// `steps` steps or more, until `swaps` versions took over meanwhile.
  std::string watched(std::uint64_t steps, std::uint64_t swaps) {
    std::atomic<std::uint64_t> swapped = 0, stepped = 0;
    std::atomic<bool> done = false;
    std::thread([&] {
      watch_this_thread();
      double y = 0;
      for (std::size_t k = 0; stepped < steps || swapped < swaps; ++k) {
        if ((runner_->step(&u_[inputs * (k % input_rows)], &y) & REIDENT_SWAPPED) != 0) ++swapped;
        ++stepped;
      }
      done = true;
      while (true) {  // its end would be a system call
      }
    }).detach();
    for (std::uint64_t seen = 0; !done;) {
      if (seen < swaps) writer_.write(versions_.make(++published_));
      while (!done && swapped == seen) std::this_thread::yield();
      seen = swapped;
    }
    return fmt::format(
        "\"steps\": {}, \"swaps\": {}, \"allocations\": {}, "
        "\"system_calls\": {}",
        stepped.load(), swapped.load(), allocations(), system_calls());
  }

 private:
  dds::Endpoint endpoint_{1 + static_cast<std::uint32_t>(getpid()) % 90,
                          fmt::format("step-{}", getpid())};
  Versions versions_;
  std::vector<double> u_ = smooth_inputs();
  std::int64_t published_ = 0;
  dds::Participant participant_{endpoint_};
  dds::Writer<ModelVersion> writer_{participant_};
  std::optional<Client> client_;
  std::optional<Runner> runner_;
};

}  // namespace
}  // namespace reident::bench

int main(int argc, char** argv) try {
  if (argc != 4) {
    std::fprintf(stderr, "usage: reident_step_bench REPETITIONS STEPS SWAPS\n");
    return 2;
  }
  reident::bench::Bench bench;
  const std::string times = bench.times(std::strtoul(argv[1], nullptr, 10));
  const std::string watched =
      bench.watched(std::strtoull(argv[2], nullptr, 10), std::strtoull(argv[3], nullptr, 10));
  std::printf("{%s, %s}\n", times.c_str(), watched.c_str());
  std::fflush(stdout);
  _exit(0);  // the watched thread runs on
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
