// The participant of the middleware behind a Participant. A secured one is replaced when its files
// change, since the middleware reads them once.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "service/dds/entity.hpp"
#include "service/security/material.hpp"
#include "service/security/roles.hpp"
#include "service/support/mutex.hpp"

namespace reident::dds {

/// Returns a handle of a domain or a participant; throws Error for a failure to join.
dds_entity_t joined_domain(dds_entity_t result, const char* call, std::uint32_t domain);

/// One participant of the middleware. Readers and writers share it; the last one ends it.
struct Session {
  /// `material` is null where the domain is not secured. Throws Error.
  Session(const Endpoint& endpoint, std::shared_ptr<const security::Material> files);

  /// Returns a reader, writer or topic of this session; throws Error where `result` is a failure. A
  /// denied one names the role, and the grant that is missing.
  Entity made(dds_entity_t result, const char* call, const char* topic,
              security::Direction direction) const;

  /// Throws Error where the certificate has ended: the middleware dies where it is asked for a
  /// reader or a writer then.
  void require_valid(const char* topic) const;

  std::string partition;
  std::shared_ptr<const security::Material> material;
  Entity participant;
  Entity publisher;  // in the partition, as is the subscriber
  Entity subscriber;
};
/// What a secured participant says about itself in the clear, as user data.
inline constexpr std::string_view secured_mark = "reident secured";

using SharedSession = std::shared_ptr<const Session>;

/// How long readers and writers stay in a session after they joined the next one: discovery and
/// handshakes take a second or two.
inline constexpr std::chrono::seconds session_overlap{10};

/// Who has to be asked to follow into a new session, as its own thread may do nothing for long.
class Follower {
 public:
  /// From the keeper's thread, once a second. Blocks for a moment at most.
  virtual void follow() noexcept = 0;

 protected:
  ~Follower() = default;
};

/// The newest session, and the thread that looks at the files of a secured one.
class SessionKeeper {
 public:
  /// Throws Error.
  explicit SessionKeeper(const Endpoint& endpoint);
  ~SessionKeeper();
  SessionKeeper(const SessionKeeper&) = delete;
  SessionKeeper& operator=(const SessionKeeper&) = delete;

  SharedSession newest() const;
  /// Whether a session is the newest.
  bool is_newest(const SharedSession& session) const { return session.get() == newest_; }
  bool is_secured() const { return !endpoint_.security.empty(); }
  std::string warning() const;

  /// A follower is asked until it is removed. Removal waits for a call that runs.
  void add(Follower& follower);
  void remove(Follower& follower);

 private:
  void watch();  // the thread
  void look();
  /// Takes up files that changed, if they are right.
  void take_up(std::int64_t now);
  void warn(std::string text);

  const Endpoint endpoint_;
  mutable Mutex mutex_;
  SharedSession session_ REIDENT_GUARDED_BY(mutex_);
  std::string warning_ REIDENT_GUARDED_BY(mutex_);
  std::atomic<const Session*> newest_ = nullptr;
  // The thread's: what is wrong with files that changed, and for how many looks.
  std::string fault_;
  int wrong_looks_ = 0;
  Mutex followers_mutex_;
  std::vector<Follower*> followers_ REIDENT_GUARDED_BY(followers_mutex_);
  Mutex stop_mutex_;
  CondVar stop_changed_;
  bool stopping_ REIDENT_GUARDED_BY(stop_mutex_) = false;
  std::thread thread_;
};

}  // namespace reident::dds
