// frame_sender DOMAIN PARTITION HISTORY COUNT SAMPLES: waits for a reader, writes the frames 1 to
// COUNT as fast as the reader takes them, waits until all are acknowledged, and leaves.
#include <cstdlib>

#include "tests/service/dds/dds_fixture.hpp"

int main(int argc, char** argv) {
  using namespace reident;
  if (argc != 6) return 2;
  dds::Participant participant({static_cast<std::uint32_t>(std::atoi(argv[1])), argv[2]});
  dds::Writer<storage::TelemetryFrame> writer(participant, {.history = std::atoi(argv[3])});
  if (!test::eventually([&] { return writer.matched_readers() > 0; })) return 3;
  const auto count = static_cast<std::uint64_t>(std::atoll(argv[4]));
  const auto samples = static_cast<std::size_t>(std::atoll(argv[5]));
  for (std::uint64_t i = 1; i <= count; ++i) writer.write(test::make_frame(i, samples));
  return writer.wait_for_acknowledgments(std::chrono::seconds(60)) ? 0 : 4;
}
