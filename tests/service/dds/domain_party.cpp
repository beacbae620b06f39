// One that takes part in all twelve topics of a domain as far as it can, by the middleware alone
// and without any check of its own: an honest member of some role, or an intruder.
//
//   domain_party FOLDER|none DOMAIN PARTITION MARK [ACCESS_LIBRARY]
//
// Each sample that it writes carries MARK. It writes on each topic five times a second until its
// standard input ends. It prints "ready", "heard" once it has 50 samples of somebody else, and at
// the end one JSON object: by topic, whether the reader and the writer
// could be made, and how many samples of each mark were taken.

#include <cstdio>
#include <fcntl.h>
#include <map>
#include <memory>
#include <poll.h>
#include <string>
#include <unistd.h>
#include <vector>

#include <dds/dds.h>

#include "reident.h"
#include "satcs.h"

namespace {

using Qos = std::unique_ptr<dds_qos_t, void (*)(dds_qos_t*)>;

Qos make_qos() {
  return {dds_create_qos(), dds_delete_qos};
}

/// A topic, and the member of its type that carries the mark.
struct Topic {
  const char* name;
  const dds_topic_descriptor_t* type;
  bool keeps_history;
  dds_return_t (*write)(dds_entity_t writer, char* mark);
  const char* (*mark)(const void* sample);
};

template <class Wire, char* Wire::*member>
dds_return_t write_marked(dds_entity_t writer, char* mark) {
  Wire wire{};
  wire.*member = mark;
  return dds_write(writer, &wire);
}

template <class Wire, char* Wire::*member>
const char* mark_of(const void* sample) {
  const char* text = static_cast<const Wire*>(sample)->*member;
  return text == nullptr ? "" : text;
}

template <class Wire, char* Wire::*member>
Topic topic(const char* name, const dds_topic_descriptor_t& type, bool keeps_history) {
  return {name, &type, keeps_history, write_marked<Wire, member>, mark_of<Wire, member>};
}

std::vector<Topic> all_topics() {
  return {topic<satcs_TelemetryFrame, &satcs_TelemetryFrame::spacecraft>(
              "satcs/TelemetryFrame", satcs_TelemetryFrame_desc, true),
          topic<satcs_ParameterDescriptor, &satcs_ParameterDescriptor::spacecraft>(
              "satcs/ParameterDescriptor", satcs_ParameterDescriptor_desc, true),
          topic<reident_ModelVersion, &reident_ModelVersion::spacecraft>(
              "reident/ModelVersion", reident_ModelVersion_desc, true),
          topic<reident_IdentificationReport, &reident_IdentificationReport::spacecraft>(
              "reident/IdentificationReport", reident_IdentificationReport_desc, true),
          topic<reident_ModelAcknowledgement, &reident_ModelAcknowledgement::simulator>(
              "reident/ModelAcknowledgement", reident_ModelAcknowledgement_desc, true),
          topic<reident_ServiceStatus, &reident_ServiceStatus::service>(
              "reident/ServiceStatus", reident_ServiceStatus_desc, true),
          topic<reident_HistoryRequest, &reident_HistoryRequest::requester>(
              "reident/HistoryRequest", reident_HistoryRequest_desc, false),
          topic<reident_HistoryReply, &reident_HistoryReply::requester>(
              "reident/HistoryReply", reident_HistoryReply_desc, false),
          topic<reident_Command, &reident_Command::requester>("reident/Command",
                                                              reident_Command_desc, false),
          topic<reident_CommandReply, &reident_CommandReply::requester>(
              "reident/CommandReply", reident_CommandReply_desc, false),
          topic<reident_Leadership, &reident_Leadership::service>("reident/Leadership",
                                                                  reident_Leadership_desc, true),
          topic<reident_Replica, &reident_Replica::sender>("reident/Replica", reident_Replica_desc,
                                                           false)};
}

Qos participant_qos(const std::string& folder, const char* access_library) {
  Qos qos = make_qos();
  if (folder == "none") return qos;
  const auto set = [&qos](const std::string& name, const std::string& value) {
    dds_qset_prop(qos.get(), name.c_str(), value.c_str());
  };
  const auto set_plugin = [&set](const std::string& kind, const std::string& library,
                                 const std::string& plugin) {
    set(kind + ".library.path", library);
    set(kind + ".library.init", "init_" + plugin);
    set(kind + ".library.finalize", "finalize_" + plugin);
  };
  set_plugin("dds.sec.auth", "dds_security_auth", "authentication");
  set_plugin("dds.sec.crypto", "dds_security_crypto", "crypto");
  set_plugin("dds.sec.access", access_library, "access_control");
  const auto set_file = [&](const char* name, const char* file) {
    set(name, "file:" + folder + "/" + file);
  };
  set_file("dds.sec.auth.identity_ca", "identity_authority.pem");
  set_file("dds.sec.auth.identity_certificate", "certificate.pem");
  set_file("dds.sec.auth.private_key", "key.pem");
  set_file("org.eclipse.cyclonedds.sec.auth.crl", "revoked.pem");
  set_file("dds.sec.access.permissions_ca", "permissions_authority.pem");
  set_file("dds.sec.access.governance", "governance.p7s");
  set_file("dds.sec.access.permissions", "permissions.p7s");
  return qos;
}

struct Part {
  Topic topic;
  dds_entity_t reader = 0, writer = 0;
  std::map<std::string, int> taken;  // by mark
};

Part take_part(const Topic& topic, dds_entity_t participant, dds_entity_t publisher,
               dds_entity_t subscriber) {
  Part part{topic, 0, 0, {}};
  const dds_entity_t entity =
      dds_create_topic(participant, topic.type, topic.name, nullptr, nullptr);
  const Qos qos = make_qos();
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(10));
  dds_qset_durability(
      qos.get(), topic.keeps_history ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  part.reader = dds_create_reader(subscriber, entity, qos.get(), nullptr);
  part.writer = dds_create_writer(publisher, entity, qos.get(), nullptr);
  return part;
}

void take(Part& part) {
  if (part.reader <= 0) return;
  constexpr std::size_t at_most = 64;
  void* samples[at_most] = {};
  dds_sample_info_t infos[at_most];
  const dds_return_t count = dds_take(part.reader, samples, infos, at_most, at_most);
  for (dds_return_t i = 0; i < count; ++i)
    if (infos[i].valid_data) ++part.taken[part.topic.mark(samples[i])];
  if (count > 0) dds_return_loan(part.reader, samples, count);
}

bool has_heard_others(const std::vector<Part>& parts, const std::string& mark) {
  constexpr int enough = 50;
  for (const Part& part : parts)
    for (const auto& [from, count] : part.taken)
      if (from != mark && count >= enough) return true;
  return false;
}

/// Whether standard input has ended by then.
bool has_ended(int wait_ms) {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  char byte = 0;
  return ::poll(&input, 1, wait_ms) > 0 && ::read(STDIN_FILENO, &byte, 1) == 0;
}

void print(const std::vector<Part>& parts, bool joined) {
  std::printf("{\"joined\": %s", joined ? "true" : "false");
  for (const Part& part : parts) {
    std::printf(", \"%s\": {\"reader\": %s, \"writer\": %s, \"taken\": {", part.topic.name,
                part.reader > 0 ? "true" : "false", part.writer > 0 ? "true" : "false");
    const char* separator = "";
    for (const auto& [mark, count] : part.taken) {
      std::printf("%s\"%s\": %d", separator, mark.c_str(), count);
      separator = ", ";
    }
    std::printf("}}");
  }
  std::printf("}\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) return 2;
  const std::string folder = argv[1], partition = argv[3];
  std::string mark = argv[4];
  const auto domain = static_cast<dds_domainid_t>(std::stoul(argv[2]));
  const Qos qos = participant_qos(folder, argc > 5 ? argv[5] : "dds_security_ac");
  const dds_entity_t participant = dds_create_participant(domain, qos.get(), nullptr);
  std::vector<Part> parts;
  if (participant > 0) {
    const Qos in_partition = make_qos();
    dds_qset_partition1(in_partition.get(), partition.c_str());
    const dds_entity_t publisher = dds_create_publisher(participant, in_partition.get(), nullptr);
    const dds_entity_t subscriber = dds_create_subscriber(participant, in_partition.get(), nullptr);
    for (const Topic& topic : all_topics())
      parts.push_back(take_part(topic, participant, publisher, subscriber));
  }
  std::printf("ready\n");
  std::fflush(stdout);
  constexpr int interval_ms = 200;
  for (bool told = false; !has_ended(interval_ms);) {
    for (Part& part : parts) {
      if (part.writer > 0) part.topic.write(part.writer, mark.data());
      take(part);
    }
    if (told || !has_heard_others(parts, mark)) continue;
    std::printf("heard\n");
    std::fflush(stdout);
    told = true;
  }
  print(parts, participant > 0);
  // Its threads make handshakes by OpenSSL, which is taken down when main ends.
  if (participant > 0) dds_delete(participant);
  return 0;
}
