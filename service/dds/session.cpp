#include "service/dds/session.hpp"

#include <algorithm>
#include <csignal>
#include <utility>

#include <fmt/format.h>

#include "service/dds/qos.hpp"
#include "service/support/log.hpp"
#include "service/support/text.hpp"
#include "service/support/time_text.hpp"
#include "service/support/utc_clock.hpp"

namespace reident::dds {
namespace {

using namespace std::chrono_literals;

constexpr auto look_interval = 1s;
constexpr int looks_of_a_change = 3;  // files are replaced one after the other

security::Material checked(const std::filesystem::path& folder) {
  auto read = security::read_material(folder, utc_now());
  if (auto* material = std::get_if<security::Material>(&read)) return std::move(*material);
  std::string text = "the domain is secured, and nothing was joined";
  for (const std::string& mistake : std::get<std::vector<std::string>>(read))
    text += "\n  " + mistake;
  throw Error(text);
}

std::shared_ptr<const security::Material> material_of(const Endpoint& endpoint) {
  if (endpoint.security.empty()) return nullptr;
  return std::make_shared<const security::Material>(checked(endpoint.security));
}

/// The middleware gets the bytes that were checked, not the files.
Qos participant_qos(const security::Material* material) {
  if (material == nullptr) return {};
  Qos qos(dds_create_qos());
  dds_qset_userdata(qos.get(), secured_mark.data(), secured_mark.size());
  const auto set = [&qos](const char* name, const std::string& value) {
    dds_qset_prop(qos.get(), name, value.c_str());
  };
  const auto set_plugin = [&set](const std::string& kind, const char* library,
                                 const std::string& plugin) {
    set((kind + ".library.path").c_str(), library);
    set((kind + ".library.init").c_str(), "init_" + plugin);
    set((kind + ".library.finalize").c_str(), "finalize_" + plugin);
  };
  set_plugin("dds.sec.auth", "dds_security_auth", "authentication");
  set_plugin("dds.sec.crypto", "dds_security_crypto", "crypto");
  set_plugin("dds.sec.access", "dds_security_ac", "access_control");
  const auto set_data = [&set](const char* name, const std::string& content) {
    set(name, "data:," + content);
  };
  set_data("dds.sec.auth.identity_ca", material->identity_authority);
  set_data("dds.sec.auth.identity_certificate", material->certificate);
  set_data("dds.sec.auth.private_key", material->key);
  set_data("org.eclipse.cyclonedds.sec.auth.crl", material->revoked);
  set_data("dds.sec.access.permissions_ca", material->permissions_authority);
  set_data("dds.sec.access.governance", material->governance);
  set_data("dds.sec.access.permissions", material->permissions);
  return qos;
}

std::string denial(const security::Material& material, const std::string& partition,
                   const char* topic, security::Direction direction) {
  const char* what = direction == security::Direction::publish ? "publish" : "subscribe to";
  const std::string who = fmt::format("{} {} may not {} {} in partition {}", material.role,
                                      material.name, what, topic, partition);
  const security::Role* role = security::find_role(material.role);
  if (role != nullptr && security::may(*role, direction, topic))
    return fmt::format(
        "{}: {} is for the partitions {}; 'reident security grant SITE {} NAME --partition {}' "
        "makes one that is",
        who, (material.folder / security::file::permissions).string(), joined(material.partitions),
        material.role, partition);
  const std::string roles = security::roles_that_may(direction, topic);
  return fmt::format(
      "{}: the role has no such grant; roles that have one: {} ('reident security "
      "grant SITE ROLE NAME')",
      who, roles.empty() ? "none" : roles);
}

/// A thread that takes no signal: they are the program's.
template <class Work>
std::thread without_signals(Work work) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread(std::move(work));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return thread;
}

}  // namespace

dds_entity_t joined_domain(dds_entity_t result, const char* call, std::uint32_t domain) {
  if (result >= 0) return result;
  throw Error(
      std::string(call) + " failed for domain " + std::to_string(domain) + ": " +
      dds_strretcode(result) +
      "; use a domain from 0 to 230, and at most 104 simulators and 16 other processes of a domain "
      "on a machine, and where CYCLONEDDS_URI is set, check the configuration and the interfaces "
      "it names");
}

Session::Session(const Endpoint& endpoint, std::shared_ptr<const security::Material> files)
    : partition(endpoint.partition),
      material(std::move(files)),
      participant(joined_domain(
          dds_create_participant(endpoint.domain, participant_qos(material.get()).get(), nullptr),
          "dds_create_participant", endpoint.domain)) {
  const std::string about = "partition \"" + partition + "\"";
  const Qos qos = partition_qos(partition);
  publisher = {dds_create_publisher(participant.get(), qos.get(), nullptr), "dds_create_publisher",
               about};
  subscriber = {dds_create_subscriber(participant.get(), qos.get(), nullptr),
                "dds_create_subscriber", about};
}

Entity Session::made(dds_entity_t result, const char* call, const char* topic,
                     security::Direction direction) const {
  if (result == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY && material)
    throw Error(denial(*material, partition, topic, direction));
  return {result, call, topic};
}

void Session::require_valid(const char* topic) const {
  if (material && material->end <= utc_now())
    throw Error(fmt::format("{}: {}", topic, security::end_warning(*material, utc_now())));
}

SessionKeeper::SessionKeeper(const Endpoint& endpoint)
    : endpoint_(endpoint), session_(std::make_shared<Session>(endpoint, material_of(endpoint))) {
  newest_ = session_.get();
  if (!is_secured()) return;
  warn(security::end_warning(*session_->material, utc_now()));
  thread_ = without_signals([this] { watch(); });
}

SessionKeeper::~SessionKeeper() {
  if (!thread_.joinable()) return;
  {
    const MutexLock lock(stop_mutex_);
    stopping_ = true;
  }
  stop_changed_.notify_all();
  thread_.join();
}

SharedSession SessionKeeper::newest() const {
  const MutexLock lock(mutex_);
  return session_;
}

std::string SessionKeeper::warning() const {
  const MutexLock lock(mutex_);
  return warning_;
}

void SessionKeeper::add(Follower& follower) {
  const MutexLock lock(followers_mutex_);
  followers_.push_back(&follower);
}

void SessionKeeper::remove(Follower& follower) {
  const MutexLock lock(followers_mutex_);
  std::erase(followers_, &follower);
}

void SessionKeeper::watch() {
  const MutexLock lock(stop_mutex_);
  while (!stopping_) {
    stop_changed_.wait_for(stop_mutex_, look_interval);
    if (stopping_) return;
    try {
      look();
    } catch (const std::exception& error) {
      warn(error.what());
    }
  }
}

void SessionKeeper::look() {
  const std::int64_t now = utc_now();
  take_up(now);
  const std::string end = security::end_warning(*newest()->material, now);
  warn(end.empty() || fault_.empty() ? end + fault_ : end + " " + fault_);
  const MutexLock lock(followers_mutex_);
  for (Follower* follower : followers_) follower->follow();
}

void SessionKeeper::take_up(std::int64_t now) {
  if (security::is_unchanged(*newest()->material)) {
    wrong_looks_ = 0;
    fault_.clear();
    return;
  }
  auto read = security::read_material(endpoint_.security, now);
  if (const auto* mistakes = std::get_if<std::vector<std::string>>(&read)) {
    if (++wrong_looks_ >= looks_of_a_change)
      fault_ = fmt::format("Files changed and are not taken up: {}.", mistakes->front());
    return;
  }
  wrong_looks_ = 0;
  fault_.clear();
  auto& material = std::get<security::Material>(read);
  const auto before = newest()->material;
  if (material.subject != before->subject || material.partitions != before->partitions) {
    // The middleware goes by the permissions that the process had first.
    fault_ = fmt::format("{} has another name, role or partitions now: restart the program.",
                         endpoint_.security.string());
    return;
  }
  auto session = std::make_shared<Session>(
      endpoint_, std::make_shared<const security::Material>(std::move(material)));
  log::info("dds", "took up new files of security",
            {{"folder", endpoint_.security.string()},
             {"member", security::description(*session->material)}});
  const MutexLock lock(mutex_);
  newest_ = session.get();
  session_ = std::move(session);
}

void SessionKeeper::warn(std::string text) {
  const MutexLock lock(mutex_);
  if (text == warning_) return;
  if (!text.empty()) log::warning("dds", text);
  warning_ = std::move(text);
}

}  // namespace reident::dds
