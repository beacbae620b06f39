// Publishes versions exactly as its input says, good and bad, a JSON object a line, for as long as
// the pipe is open; prints a line for each:
//   {"number": 3, "model": {...}, "rollback": true, "decided_ns": 1, "spoil": "nan"}
// The digest is that of the model. `spoil` changes what was signed, or goes round our own writer's
// checks: digest, truncated, order, format, nan, number.
// Usage: publish_versions PIPE DOMAIN PARTITION

#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <map>

#include <nlohmann/json.hpp>

#include "service/dds/codec.hpp"
#include "service/dds/domain.hpp"
#include "service/dds/entity.hpp"
#include "service/model/model_json.hpp"

namespace {

using nlohmann::json;
using namespace reident;

ModelVersion version_of(const json& order) {
  ModelVersion version;
  version.model = equipment_model_from_json(order.at("model").dump());
  version.number = order.at("number").get<std::int64_t>();
  version.digest = model_digest(version.model);
  version.decided = order.value("decided_ns", std::int64_t{1'600'000'000'000'000'000});
  version.decided_by = "gate";
  version.rollback = order.value("rollback", false);
  version.program_version = "test";
  return version;
}

const std::map<std::string, std::function<void(reident_ModelVersion&)>> spoils = {
    {"", [](reident_ModelVersion&) {}},
    {"digest", [](reident_ModelVersion& wire) { wire.B._buffer[0] *= 1.5; }},
    {"truncated", [](reident_ModelVersion& wire) { wire.A._length -= 1; }},
    {"order", [](reident_ModelVersion& wire) { wire.order += 1; }},
    {"format", [](reident_ModelVersion& wire) { wire.format = reident_MODEL_FORMAT + 1; }},
    {"nan",
     [](reident_ModelVersion& wire) {
       wire.C._buffer[0] = std::numeric_limits<double>::quiet_NaN();
     }},
    {"number", [](reident_ModelVersion& wire) { wire.number = -wire.number; }},
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: publish_versions PIPE DOMAIN PARTITION\n";
    return 2;
  }
  dds::Participant participant({static_cast<std::uint32_t>(std::stoul(argv[2])), argv[3]});
  const dds::Entity topic(
      dds_create_topic(participant.impl().sessions.newest()->participant.get(),
                       &reident_ModelVersion_desc, dds::model_version.topic, nullptr, nullptr),
      "dds_create_topic", dds::model_version.topic);
  const dds::Entity writer(
      dds_create_writer(participant.impl().sessions.newest()->publisher.get(), topic.get(),
                        dds::writer_qos(dds::model_version, {}).get(), nullptr),
      "dds_create_writer", dds::model_version.topic);
  std::ifstream orders(argv[1]);
  dds::Codec<ModelVersion>::Encoder encode;
  for (std::string line; std::getline(orders, line);) {
    const json order = json::parse(line);
    const ModelVersion version = version_of(order);
    reident_ModelVersion wire = encode(version);
    spoils.at(order.value("spoil", ""))(wire);
    dds::check(dds_write(writer.get(), &wire), "dds_write", dds::model_version.topic);
    std::cout << version.number << std::endl;
  }
  return 0;
}
