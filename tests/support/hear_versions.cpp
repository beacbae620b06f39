// Hears published versions as a simulator does, and prints each as a line of JSON with the time at
// which it came, in seconds of the monotonic clock, until it is killed. For the end-to-end tests.
// Usage: hear_versions DOMAIN PARTITION

#include <chrono>
#include <iostream>

#include <fmt/format.h>

#include "service/dds/dds.hpp"

namespace {

[[noreturn]] void hear(std::uint32_t domain, const std::string& partition) {
  using namespace std::chrono_literals;
  reident::dds::Participant participant({domain, partition, {}, true});
  reident::dds::Reader<reident::ModelVersion> versions(participant);
  reident::dds::WaitSet ready(participant);
  ready.attach(versions);
  std::cout << "{}" << std::endl;  // it listens
  while (true) {
    ready.wait(50ms);
    versions.take(64, [](reident::ModelVersion&& version) {
      const std::chrono::duration<double> now = std::chrono::steady_clock::now().time_since_epoch();
      std::cout << fmt::format(
                       R"({{"at": {:.6f}, "equipment": "{}", "version": {}, "digest": "{}", )"
                       R"("rollback": {}}})",
                       now.count(), version.model.equipment, version.number, version.digest,
                       version.rollback)
                << std::endl;
    });
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 3) return 2;
    hear(static_cast<std::uint32_t>(std::stoul(argv[1])), argv[2]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
