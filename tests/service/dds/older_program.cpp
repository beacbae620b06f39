// older_program read|write|hear|acknowledge DOMAIN PARTITION: a program that was compiled against
// older_model.idl. `read` prints one line about the first version that it receives, `hear` about
// the first acknowledgement; `write` publishes a version, `acknowledge` says that it runs, and both
// stay until they are ended.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include <dds/dds.h>

#include "older_model.h"

namespace {

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos state_qos() {
  Qos qos(dds_create_qos(), dds_delete_qos);
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
  return qos;
}

/// Calls `print` with the first sample of the topic.
template <class Print>
int take_one(dds_entity_t participant, dds_entity_t topic, const dds_qos_t* partition,
             const Print& print) {
  const dds_entity_t subscriber = dds_create_subscriber(participant, partition, nullptr);
  const dds_entity_t reader = dds_create_reader(subscriber, topic, state_qos().get(), nullptr);
  const dds_entity_t wait_set = dds_create_waitset(participant);
  dds_waitset_attach(wait_set, dds_create_readcondition(reader, DDS_ANY_STATE), 0);
  if (dds_waitset_wait(wait_set, nullptr, 0, DDS_SECS(20)) <= 0) return 3;
  void* sample = nullptr;
  dds_sample_info_t info;
  if (dds_take(reader, &sample, &info, 1, 1) != 1 || !info.valid_data) return 4;
  print(sample);
  dds_return_loan(reader, &sample, 1);
  return 0;
}

int read(dds_entity_t participant, dds_entity_t topic, const dds_qos_t* partition) {
  return take_one(participant, topic, partition, [](const void* sample) {
    const auto* version = static_cast<const reident_ModelVersion*>(sample);
    std::printf("%s/%s %ld %s %s %g %u\n", version->spacecraft, version->equipment,
                static_cast<long>(version->number), version->digest,
                version->inputs._buffer[0].name, version->A._buffer[0],
                version->fit_percent._length);
  });
}

int hear(dds_entity_t participant, dds_entity_t topic, const dds_qos_t* partition) {
  return take_one(participant, topic, partition, [](const void* sample) {
    const auto* said = static_cast<const reident_ModelAcknowledgement*>(sample);
    std::printf("%s %s/%s %ld %d %g\n", said->simulator, said->spacecraft, said->equipment,
                static_cast<long>(said->version), said->accepted ? 1 : 0,
                said->running_mrse_percent);
  });
}

/// Writes the sample and stays.
int say(dds_entity_t participant, dds_entity_t topic, const dds_qos_t* partition,
        const void* sample) {
  const dds_entity_t publisher = dds_create_publisher(participant, partition, nullptr);
  const dds_entity_t writer = dds_create_writer(publisher, topic, state_qos().get(), nullptr);
  if (dds_write(writer, sample) != DDS_RETCODE_OK) return 5;
  dds_sleepfor(DDS_SECS(60));
  return 0;
}

int acknowledge(dds_entity_t participant, dds_entity_t topic, const dds_qos_t* partition) {
  std::string simulator = "trainer";
  std::string spacecraft = "CBERS4";
  std::string equipment = "BDR";
  std::string text = "ab";
  const reident_ModelAcknowledgement said{simulator.data(),
                                          spacecraft.data(),
                                          equipment.data(),
                                          4,
                                          text.data(),
                                          5,
                                          true,
                                          text.data(),
                                          1.5};
  return say(participant, topic, partition, &said);
}

int write(dds_entity_t participant, dds_entity_t topic, const dds_qos_t* partition) {
  std::string spacecraft = "CBERS4";
  std::string equipment = "BDR";
  std::string name = "I_BDRIN1";
  std::string unit = "A";
  std::string digest = "0123";
  std::array<double, 1> number{0.5};
  reident_Signal signal{name.data(), unit.data(), -1};
  reident_ModelVersion version{};
  version.spacecraft = spacecraft.data();
  version.equipment = equipment.data();
  version.format = 1;
  version.number = 4;
  version.digest = digest.data();
  version.decided_by = unit.data();
  version.program_version = unit.data();
  version.sample_period_s = 1;
  version.hold_ns = 1;
  version.order = 1;
  version.inputs = {1, 1, &signal, false};
  version.outputs = {1, 1, &signal, false};
  for (auto* sequence : {&version.A, &version.B, &version.C, &version.D, &version.input_offset,
                         &version.output_offset, &version.mrse_percent, &version.fit_percent}) {
    *sequence = {1, 1, number.data(), false};
  }
  return say(participant, topic, partition, &version);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto domain = static_cast<dds_domainid_t>(std::atoi(argv[2]));
  const dds_entity_t participant = dds_create_participant(domain, nullptr, nullptr);
  const bool about_versions =
      std::strcmp(argv[1], "read") == 0 || std::strcmp(argv[1], "write") == 0;
  const dds_entity_t topic = dds_create_topic(
      participant, about_versions ? &reident_ModelVersion_desc : &reident_ModelAcknowledgement_desc,
      about_versions ? "reident/ModelVersion" : "reident/ModelAcknowledgement", nullptr, nullptr);
  if (topic < 0) return 1;
  const Qos partition(dds_create_qos(), dds_delete_qos);
  dds_qset_partition1(partition.get(), argv[3]);
  if (std::strcmp(argv[1], "read") == 0) return read(participant, topic, partition.get());
  if (std::strcmp(argv[1], "write") == 0) return write(participant, topic, partition.get());
  if (std::strcmp(argv[1], "hear") == 0) return hear(participant, topic, partition.get());
  return acknowledge(participant, topic, partition.get());
}
