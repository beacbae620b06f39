// Runs the approved model of a battery discharge regulator on made-up currents, once a second.
//   simulator [STEPS [DOMAIN [PARTITION]]]
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include <reident/client.hpp>

int main(int argc, char** argv) try {
  const int steps = argc > 1 ? std::atoi(argv[1]) : 60;
  reident::ClientOptions options;
  if (argc > 2) options.domain = static_cast<std::uint32_t>(std::atoi(argv[2]));
  if (argc > 3) options.partition = argv[3];
  options.spacecraft = "CBERS-4";
  options.equipment = {"BDR"};
  reident::Client client(options);
  reident::Runner bdr(client, "CBERS-4", "BDR", {{"I_BDRIN1", "A"}, {"I_BDRIN2", "A"}},
                      {{"I_BDROUT", "A"}});
  for (int k = 0; k < steps; ++k) {
    const double u[] = {1 + 0.01 * (k % 50), 0.5};
    double y[1];
    const int flags = bdr.step(u, y);
    while (const auto event = client.next_event())
      std::printf("%s: %s\n", event->equipment.c_str(), event->text.c_str());
    if ((flags & REIDENT_NO_MODEL) != 0) {
      std::printf("step %d: no model yet\n", k);
    } else {
      const std::string version = std::to_string(bdr.state().version);
      std::printf("step %d: version %s, I_BDROUT %.4f A\n", k, version.c_str(), y[0]);
    }
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
} catch (const reident::ClientError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
