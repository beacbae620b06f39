// Another process that steps without a pause while a service changes the version of its equipment:
// for each swap when the service sent the version and when the first step on it was made.
//   reident_swap_bench DOMAIN PARTITION SPACECRAFT EQUIPMENT SWAPS OUTPUT INPUT...
// Prints the first version as JSON, then one JSON object a swap: {"version", "published_ns",
// "time_ns"}.
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <reident/client.hpp>

int main(int argc, char** argv) try {
  if (argc < 8) {
    std::fprintf(stderr,
                 "usage: reident_swap_bench DOMAIN PARTITION SPACECRAFT EQUIPMENT SWAPS OUTPUT "
                 "INPUT...\n");
    return 2;
  }
  reident::ClientOptions options;
  options.domain = static_cast<std::uint32_t>(std::atoi(argv[1]));
  options.partition = argv[2];
  options.cache_folder = "";
  reident::Client client(options);
  std::vector<reident::ClientSignal> inputs;
  for (int i = 7; i < argc; ++i) inputs.push_back({argv[i], ""});
  reident::Runner runner(client, argv[3], argv[4], inputs, {{argv[6], ""}});
  std::vector<double> u(inputs.size());
  double y = 0;
  int left = std::atoi(argv[5]);
  while (!client.version_json(argv[3], argv[4])) client.next_event(10);
  std::printf("%s\n", client.version_json(argv[3], argv[4])->c_str());
  std::fflush(stdout);
  for (double t = 0; left > 0; t += 0.01) {
    for (std::size_t i = 0; i < u.size(); ++i) u[i] = std::sin(t + static_cast<double>(i));
    if ((runner.step(u.data(), &y) & REIDENT_SWAPPED) == 0) continue;
    for (bool is_told = false; !is_told;) {
      const auto event = client.next_event(-1);
      is_told = event->kind == reident::ClientEvent::Kind::swapped;
      if (is_told)
        std::printf("{\"version\": %" PRId64 ", \"published_ns\": %" PRId64
                    ", \"time_ns\": %" PRId64 "}\n",
                    event->version, event->published_ns, event->time_ns);
    }
    std::fflush(stdout);
    --left;
  }
} catch (const reident::ClientError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
