#include "service/dds/domain.hpp"

#include <cstdlib>
#include <map>

#include "service/dds/qos.hpp"
#include "service/support/mutex.hpp"

namespace reident::dds {
namespace {

struct SharedDomain {
  Entity entity;  // empty where the middleware made the domain on its own
  std::size_t users = 0;
  std::size_t silences = 0;
};

Mutex domains_mutex;

std::map<std::uint32_t, SharedDomain>& domains() REIDENT_REQUIRES(domains_mutex) {
  static std::map<std::uint32_t, SharedDomain> instance;
  return instance;
}

bool configured_by_environment() {
  const char* uri = std::getenv("CYCLONEDDS_URI");
  return uri != nullptr && *uri != '\0';
}

dds_entity_t joined(dds_entity_t result, const char* call, std::uint32_t domain) {
  if (result >= 0) return result;
  throw Error(
      std::string(call) + " failed for domain " + std::to_string(domain) + ": " +
      dds_strretcode(result) +
      "; use a domain from 0 to 230 and at most 120 processes of a domain on a machine, and "
      "where CYCLONEDDS_URI is set, check the configuration and the interfaces it names");
}

Entity create_loopback_domain(std::uint32_t domain) {
  const dds_entity_t result = dds_create_domain(domain, loopback_configuration);
  // Another library of this process was first; its configuration holds.
  if (result == DDS_RETCODE_PRECONDITION_NOT_MET) return {};
  return Entity(joined(result, "dds_create_domain", domain));
}

Entity create_participant(std::uint32_t domain) {
  return Entity(
      joined(dds_create_participant(domain, nullptr, nullptr), "dds_create_participant", domain));
}

}  // namespace

DomainUse::DomainUse(std::uint32_t domain) : domain_(domain) {
  const MutexLock lock(domains_mutex);
  auto found = domains().find(domain);
  if (found == domains().end()) {
    Entity entity = configured_by_environment() ? Entity() : create_loopback_domain(domain);
    found = domains().emplace(domain, SharedDomain{std::move(entity), 0}).first;
  }
  ++found->second.users;
}

DomainUse::~DomainUse() {
  const MutexLock lock(domains_mutex);
  const auto found = domains().find(domain_);
  if (--found->second.users == 0) domains().erase(found);
}

Participant::Impl::Impl(const Endpoint& endpoint)
    : domain(endpoint.domain),
      partition(endpoint.partition),
      participant(create_participant(endpoint.domain)) {
  const std::string about = "partition \"" + partition + "\"";
  const Qos qos = partition_qos(partition);
  publisher = {dds_create_publisher(participant.get(), qos.get(), nullptr), "dds_create_publisher",
               about};
  subscriber = {dds_create_subscriber(participant.get(), qos.get(), nullptr),
                "dds_create_subscriber", about};
}

Participant::Participant(const Endpoint& endpoint) : impl_(std::make_unique<Impl>(endpoint)) {}
Participant::~Participant() = default;
Participant::Participant(Participant&&) noexcept = default;
Participant& Participant::operator=(Participant&&) noexcept = default;

Silence::Silence(Participant& participant) : participant_(participant.impl()) {
  const MutexLock lock(domains_mutex);
  std::size_t& silences = domains().at(participant_.domain.domain_).silences;
  if (silences == 0) {
    check(dds_domain_set_deafmute(participant_.participant.get(), true, false, DDS_INFINITY),
          "dds_domain_set_deafmute", "the domain");
  }
  ++silences;
}

Silence::~Silence() {
  const MutexLock lock(domains_mutex);
  if (--domains().at(participant_.domain.domain_).silences > 0) return;
  dds_domain_set_deafmute(participant_.participant.get(), false, false, DDS_INFINITY);
}

void Participant::stop_hearing() {
  if (!impl_->silence) impl_->silence.emplace(*this);
}

void Participant::hear_again() {
  impl_->silence.reset();
}

}  // namespace reident::dds
