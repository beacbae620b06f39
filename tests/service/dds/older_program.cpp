// older_program read|write DOMAIN PARTITION: a program that was compiled against older_model.idl.
// `read` prints one line about the first version that it receives; `write` publishes one and stays
// until it is ended.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <dds/dds.h>

#include "older_model.h"

namespace {

dds_qos_t* state_qos() {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
  return qos;
}

int read(dds_entity_t participant, dds_entity_t topic, const dds_qos_t* partition) {
  const dds_entity_t subscriber = dds_create_subscriber(participant, partition, nullptr);
  const dds_entity_t reader = dds_create_reader(subscriber, topic, state_qos(), nullptr);
  const dds_entity_t wait_set = dds_create_waitset(participant);
  dds_waitset_attach(wait_set, dds_create_readcondition(reader, DDS_ANY_STATE), 0);
  if (dds_waitset_wait(wait_set, nullptr, 0, DDS_SECS(20)) <= 0) return 3;
  void* sample = nullptr;
  dds_sample_info_t info;
  if (dds_take(reader, &sample, &info, 1, 1) != 1 || !info.valid_data) return 4;
  const auto* version = static_cast<const reident_ModelVersion*>(sample);
  std::printf("%s/%s %ld %s %s %g %u\n", version->spacecraft, version->equipment,
              static_cast<long>(version->number), version->digest, version->inputs._buffer[0].name,
              version->A._buffer[0], version->fit_percent._length);
  dds_return_loan(reader, &sample, 1);
  return 0;
}

int write(dds_entity_t participant, dds_entity_t topic, const dds_qos_t* partition) {
  const dds_entity_t publisher = dds_create_publisher(participant, partition, nullptr);
  const dds_entity_t writer = dds_create_writer(publisher, topic, state_qos(), nullptr);
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
  if (dds_write(writer, &version) != DDS_RETCODE_OK) return 5;
  dds_sleepfor(DDS_SECS(60));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const auto domain = static_cast<dds_domainid_t>(std::atoi(argv[2]));
  const dds_entity_t participant = dds_create_participant(domain, nullptr, nullptr);
  const dds_entity_t topic = dds_create_topic(participant, &reident_ModelVersion_desc,
                                              "reident/ModelVersion", nullptr, nullptr);
  if (topic < 0) return 1;
  dds_qos_t* partition = dds_create_qos();
  dds_qset_partition1(partition, argv[3]);
  return std::strcmp(argv[1], "read") == 0 ? read(participant, topic, partition)
                                           : write(participant, topic, partition);
}
