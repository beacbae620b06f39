// Publishes telemetry frames and descriptors exactly as a file of JSON lines says, good and bad:
//   {"descriptor": {"id": 1, "name": "U", "unit": "V"}}
//   {"frame": {"sequence": 7, "time": 1000000000, "samples": [[1, 2.5], [2, "nan"], [3, 1, 3]]}}
// A sample is [parameter, value, quality]; "repeat": N after "samples" repeats the samples N times.
// Usage: publish_frames FILE DOMAIN PARTITION SPACECRAFT SOURCE

#include <fstream>
#include <iostream>
#include <limits>

#include <nlohmann/json.hpp>

#include "service/dds/dds.hpp"
#include "tests/support/wait_for_reader.hpp"

namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using reident::storage::ParameterDescriptor;
using reident::storage::Sample;
using reident::storage::TelemetryFrame;

double number(const json& value) {
  if (value.is_number()) return value.get<double>();
  if (value == "inf") return std::numeric_limits<double>::infinity();
  if (value == "-inf") return -std::numeric_limits<double>::infinity();
  return std::numeric_limits<double>::quiet_NaN();
}

TelemetryFrame frame(const json& from, const std::string& spacecraft, const std::string& source) {
  TelemetryFrame result;
  result.spacecraft = spacecraft;
  result.source = from.value("source", source);
  result.sequence = from.at("sequence").get<std::uint64_t>();
  result.generation_time = from.at("time").get<std::int64_t>();
  result.reception_time = result.generation_time;
  for (std::size_t n = from.value("repeat", std::size_t{1}); n > 0; --n)
    for (const json& sample : from.at("samples"))
      result.samples.push_back(
          {sample.at(0).get<std::uint32_t>(),
           static_cast<reident::storage::Quality>(sample.size() > 2 ? sample.at(2).get<int>() : 0),
           number(sample.at(1))});
  return result;
}

ParameterDescriptor descriptor(const json& from, const std::string& spacecraft) {
  ParameterDescriptor result;
  result.spacecraft = spacecraft;
  result.id = from.at("id").get<std::uint32_t>();
  result.name = from.at("name").get<std::string>();
  result.unit = from.value("unit", "");
  return result;
}

void publish(char** argv) {
  reident::dds::Participant participant({static_cast<std::uint32_t>(std::stoul(argv[2])), argv[3]});
  reident::dds::Writer<ParameterDescriptor> descriptors(participant);
  reident::dds::Writer<TelemetryFrame> frames(participant);
  reident::test::wait_for_reader(descriptors);
  reident::test::wait_for_reader(frames);
  std::ifstream file(argv[1]);
  std::string line;
  while (std::getline(file, line)) {
    const json message = json::parse(line);
    if (message.contains("descriptor"))
      descriptors.write(descriptor(message["descriptor"], argv[4]));
    else
      frames.write(frame(message.at("frame"), argv[4], argv[5]));
  }
  if (!descriptors.wait_for_acknowledgments(30s) || !frames.wait_for_acknowledgments(30s))
    throw std::runtime_error("a reader did not acknowledge");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::cerr << "usage: publish_frames FILE DOMAIN PARTITION SPACECRAFT SOURCE\n";
    return 2;
  }
  try {
    publish(argv);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "publish_frames: " << error.what() << "\n";
    return 1;
  }
}
