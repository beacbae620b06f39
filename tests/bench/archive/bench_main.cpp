// reident_archive_bench: the archive and a plain table, measured in the same way.
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <time.h>

#include "tests/bench/archive/modes.hpp"

namespace reident::bench {

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// getrusage() counts what the process was before exec(), too.
double peak_mib() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == "VmHWM:") {
      double kib = 0;
      status >> kib;
      return kib / 1024;
    }
  return 0;
}

void print(const nlohmann::json& result) {
  std::cout << result << std::endl;
}

}  // namespace reident::bench

int main(int argc, char** argv) {
  CLI::App app("Measures the archive, or a plain table of samples", "reident_archive_bench");
  app.require_subcommand(1);
  reident::bench::add_append(app);
  reident::bench::add_ask(app);
  reident::bench::add_read(app);
  reident::bench::add_size(app);
  reident::bench::add_content(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "reident_archive_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
