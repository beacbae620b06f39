#include "service/dds/domain.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>

#include "service/dds/loan.hpp"
#include "service/support/mutex.hpp"

namespace reident::dds {
namespace {

struct SharedDomain {
  Entity entity;  // empty where the middleware made the domain on its own
  std::filesystem::path security;
  std::size_t users = 0;
  std::size_t silences = 0;
};

Mutex domains_mutex;

std::map<std::uint32_t, SharedDomain>& domains() REIDENT_REQUIRES(domains_mutex) {
  static std::map<std::uint32_t, SharedDomain> instance;
  return instance;
}

/// CYCLONEDDS_URI; empty where it is not set.
std::string configuration_of_environment() {
  const char* uri = std::getenv("CYCLONEDDS_URI");
  return uri == nullptr ? std::string() : uri;
}

// Discovery by unicast is all to all: 100 simulators that find each other spend half a minute of
// two cores on it. Services, sources and consoles take ports from the first on, and announce
// themselves to every port; simulators take the last ones, and announce themselves to the first.
constexpr int ports = 120;             // of participants of a domain on a machine (DDSI standard)
constexpr int ports_of_services = 16;  // before those of simulators

constexpr std::uint64_t least_unacknowledged = 500'000;  // the middleware's own

std::string simulator_discovery(std::uint32_t domain) {
  constexpr int first_offset = 10, gain = 2;  // the ports of the standard: 250 a domain
  const int first = 7400 + 250 * static_cast<int>(domain) + first_offset;
  // One port for discovery and data: no second one that another program could have taken.
  const std::string offset = std::to_string(first_offset + gain * ports_of_services);
  std::string peers;
  for (int i = 0; i < ports_of_services; ++i)
    peers += "<Peer address=\"127.0.0.1:" + std::to_string(first + gain * i) + "\"/>";
  return "<Domain Id=\"any\"><Discovery><ParticipantIndex>auto</ParticipantIndex>"
         "<MaxAutoParticipantIndex>" +
         std::to_string(ports - ports_of_services) +
         "</MaxAutoParticipantIndex><Ports><UnicastMetaOffset>" + offset +
         "</UnicastMetaOffset><UnicastDataOffset>" + offset +
         "</UnicastDataOffset></Ports><Peers>" + peers + "</Peers></Discovery></Domain>";
}

/// Empty where the endpoint has nothing that differs from the middleware's own settings.
std::string cut_configuration(const Endpoint& endpoint) {
  // The default would be half a minute with a long lease: participants that connect again after a
  // longer cut would find each other that late.
  constexpr const char* announcements = "<SPDPInterval>8s</SPDPInterval>";
  if (endpoint.lease.count() == 0) return {};
  return ",<Domain Id=\"any\"><Discovery><LeaseDuration>" + std::to_string(endpoint.lease.count()) +
         "ns</LeaseDuration>" + announcements + "</Discovery><Internal><Watermarks><WhcHigh>" +
         std::to_string(std::max(endpoint.unacknowledged_bytes, least_unacknowledged)) +
         "B</WhcHigh></Watermarks></Internal></Domain>";
}

/// What the domain is made with; empty where that is the middleware's.
std::string configuration_of(const Endpoint& endpoint) {
  const std::string cut = cut_configuration(endpoint);
  if (const std::string given = configuration_of_environment(); !given.empty())
    return cut.empty() ? std::string() : given + cut;
  if (!endpoint.simulator) return loopback_configuration + cut;
  return loopback_traffic + ("," + simulator_discovery(endpoint.domain)) + cut;
}

Entity create_domain(const Endpoint& endpoint) {
  const std::uint32_t domain = endpoint.domain;
  const std::string configuration = configuration_of(endpoint);
  if (configuration.empty()) return {};
  const dds_entity_t result = dds_create_domain(domain, configuration.c_str());
  // Another library of this process was first; its configuration holds.
  if (result == DDS_RETCODE_PRECONDITION_NOT_MET) return {};
  return Entity(joined_domain(result, "dds_create_domain", domain));
}

}  // namespace

DomainUse::DomainUse(const Endpoint& endpoint) : domain_(endpoint.domain) {
  const MutexLock lock(domains_mutex);
  auto found = domains().find(domain_);
  if (found == domains().end())
    found =
        domains().emplace(domain_, SharedDomain{create_domain(endpoint), endpoint.security}).first;
  if (found->second.security != endpoint.security) {
    const auto text = [](const std::filesystem::path& folder) {
      return folder.empty() ? "no files of security" : folder.string();
    };
    throw Error("this process uses domain " + std::to_string(domain_) + " with " +
                text(found->second.security) + " already, and with " + text(endpoint.security) +
                " now; use one folder for a domain in a process");
  }
  ++found->second.users;
}

DomainUse::~DomainUse() {
  const MutexLock lock(domains_mutex);
  const auto found = domains().find(domain_);
  if (--found->second.users == 0) domains().erase(found);
}

Participant::Impl::Impl(const Endpoint& endpoint) : domain(endpoint), sessions(endpoint) {}

Participant::Participant(const Endpoint& endpoint) : impl_(std::make_unique<Impl>(endpoint)) {}
Participant::~Participant() = default;
Participant::Participant(Participant&&) noexcept = default;
Participant& Participant::operator=(Participant&&) noexcept = default;

Silence::Silence(Participant& participant) : participant_(participant.impl()) {
  const MutexLock lock(domains_mutex);
  std::size_t& silences = domains().at(participant_.domain.domain_).silences;
  if (silences == 0) {
    check(dds_domain_set_deafmute(participant_.sessions.newest()->participant.get(), true, false,
                                  DDS_INFINITY),
          "dds_domain_set_deafmute", "the domain");
  }
  ++silences;
}

Silence::~Silence() {
  const MutexLock lock(domains_mutex);
  if (--domains().at(participant_.domain.domain_).silences > 0) return;
  dds_domain_set_deafmute(participant_.sessions.newest()->participant.get(), false, false,
                          DDS_INFINITY);
}

std::shared_ptr<const security::Material> Participant::material() const {
  return impl_->sessions.newest()->material;
}

std::string Participant::security_warning() const {
  return impl_->sessions.warning();
}

bool Participant::misses_security() const {
  const SharedSession session = impl_->sessions.newest();
  if (session->material) return false;
  const Entity others(dds_create_reader(session->participant.get(),
                                        DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
                      "dds_create_reader", "the participants of the domain");
  const Loan loan(others.get(), Loan::capacity, "the participants of the domain");
  for (std::size_t i = 0; i < loan.count; ++i) {
    if (!loan.infos[i].valid_data) continue;
    void* data = nullptr;
    std::size_t size = 0;
    dds_qget_userdata(static_cast<const dds_builtintopic_participant_t*>(loan.samples[i])->qos,
                      &data, &size);
    const bool is_secured =
        data != nullptr && std::string_view(static_cast<const char*>(data), size) == secured_mark;
    dds_free(data);
    if (is_secured) return true;
  }
  return false;
}

void Participant::stop_hearing() {
  if (!impl_->silence) impl_->silence.emplace(*this);
}

void Participant::hear_again() {
  impl_->silence.reset();
}

}  // namespace reident::dds
