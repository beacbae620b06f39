// A domain and a partition of the test's own, waiting for conditions, and sample messages.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "service/dds/dds.hpp"

namespace reident::test {

using namespace std::chrono_literals;

inline dds::Endpoint own_endpoint() {
  return {31 + static_cast<std::uint32_t>(getpid()) % 170, "test-" + std::to_string(getpid())};
}

/// Asks until the condition holds or ten seconds have passed.
inline bool eventually(const std::function<bool()>& condition, std::chrono::seconds limit = 10s) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

/// Takes until `enough` messages are there or the deadline passes.
template <class M>
std::vector<M> take_all(dds::Reader<M>& reader, std::size_t enough,
                        std::chrono::seconds limit = 10s) {
  std::vector<M> messages;
  eventually(
      [&] {
        reader.take(1000, [&](M&& message) { messages.push_back(std::move(message)); });
        return messages.size() >= enough;
      },
      limit);
  return messages;
}

inline storage::TelemetryFrame make_frame(std::uint64_t sequence, std::size_t samples = 3) {
  storage::TelemetryFrame frame{"CBERS4", "station", storage::Origin::real, sequence, 0, 0, {}};
  frame.generation_time = static_cast<storage::Time>(sequence) * 1'000'000'000;
  frame.reception_time = frame.generation_time + 5;
  for (std::size_t i = 0; i < samples; ++i) {
    frame.samples.push_back({static_cast<std::uint32_t>(i + 1), storage::Quality::good,
                             static_cast<double>(sequence) + 0.5 * static_cast<double>(i)});
  }
  return frame;
}

inline std::vector<std::uint64_t> sequences(const std::vector<storage::TelemetryFrame>& frames) {
  std::vector<std::uint64_t> numbers;
  for (const storage::TelemetryFrame& frame : frames) numbers.push_back(frame.sequence);
  return numbers;
}

/// 1, 2, ... last.
inline std::vector<std::uint64_t> count_to(std::uint64_t last) {
  std::vector<std::uint64_t> numbers;
  for (std::uint64_t i = 1; i <= last; ++i) numbers.push_back(i);
  return numbers;
}

}  // namespace reident::test
