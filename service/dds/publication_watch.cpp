#include "service/dds/publication_watch.hpp"

#include <cstdint>
#include <cstring>
#include <fnmatch.h>
#include <utility>

#include "service/dds/loan.hpp"

namespace reident::dds {
namespace {

/// Either name may be a pattern; one that holds a bracket is no pattern to the middleware.
bool match(const char* one, const char* other) {
  return std::strcmp(one, other) == 0 || fnmatch(one, other, FNM_NOESCAPE) == 0 ||
         fnmatch(other, one, FNM_NOESCAPE) == 0;
}

}  // namespace

PublicationWatch::PublicationWatch(const Session& session, std::string topic)
    : topic_(std::move(topic)),
      partition_(session.partition),
      publications_(dds_create_reader(session.participant.get(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
                                      nullptr, nullptr),
                    "dds_create_reader", "the publications of the domain"),
      has_publications_(dds_create_readcondition(publications_.get(), DDS_ANY_STATE),
                        "dds_create_readcondition", "the publications of the domain") {}

PublicationWatch::Unmatched PublicationWatch::take() {
  Unmatched unmatched;
  for (;;) {
    const Loan loan(publications_.get(), Loan::capacity, "the publications of the domain");
    if (loan.count == 0) return unmatched;
    for (std::size_t i = 0; i < loan.count; ++i) {
      if (!loan.infos[i].valid_data) continue;
      look_at(*static_cast<const dds_builtintopic_endpoint_t*>(loan.samples[i]), unmatched);
    }
  }
}

void PublicationWatch::look_at(const dds_builtintopic_endpoint_t& writer,
                               Unmatched& unmatched) const {
  if (topic_ != writer.topic_name || !is_in_partition(writer.qos)) return;
  dds_reliability_kind_t reliability = DDS_RELIABILITY_RELIABLE;
  dds_qget_reliability(writer.qos, &reliability, nullptr);
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_qget_durability(writer.qos, &durability);
  if (reliability == DDS_RELIABILITY_BEST_EFFORT) {
    unmatched.best_effort = true;
  } else if (durability == DDS_DURABILITY_VOLATILE) {
    unmatched.reliable_volatile = true;
  }
}

bool PublicationWatch::is_in_partition(const dds_qos_t* qos) const {
  std::uint32_t count = 0;
  char** names = nullptr;
  dds_qget_partition(qos, &count, &names);
  bool found = count == 0 && match("", partition_.c_str());
  for (std::uint32_t i = 0; i < count; ++i) {
    found = found || match(names[i], partition_.c_str());
    dds_free(names[i]);
  }
  dds_free(names);
  return found;
}

}  // namespace reident::dds
