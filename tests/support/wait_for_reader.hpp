// For programs of the tests that publish.
#pragma once

#include <chrono>
#include <stdexcept>
#include <thread>

#include "service/dds/dds.hpp"

namespace reident::test {

/// Returns when a reader has found the writer. Throws std::runtime_error after half a minute.
template <class M>
void wait_for_reader(const dds::Writer<M>& writer) {
  using namespace std::chrono_literals;
  const auto deadline = std::chrono::steady_clock::now() + 30s;
  while (writer.matched_readers() == 0) {
    if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("no reader came");
    std::this_thread::sleep_for(10ms);  // poll
  }
}

}  // namespace reident::test
