// The domain of a process, configured once and shared by its participants. What counts its users
// and silences is guarded by one mutex of the process: any thread may make and end them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "service/dds/session.hpp"

namespace reident::dds {

/// Cyclone DDS configuration that keeps all traffic on 127.0.0.1 (service/dds/loopback.xml).
extern const char* const loopback_configuration;
/// loopback_configuration without its part about discovery.
extern const char* const loopback_traffic;

/// Keeps a domain configured for as long as anyone in the process uses it. Without CYCLONEDDS_URI
/// the domain is the loopback one; with it the middleware reads the configuration itself.
class DomainUse {
 public:
  /// Makes the domain where it has none in this process. All of the endpoint but the partition
  /// counts then alone. Where another library of the process made the domain before, its
  /// configuration holds. Throws Error, also where the process uses the domain with other files of
  /// security, or with some and without: the middleware keeps one set of permissions, and fails
  /// without words.
  explicit DomainUse(const Endpoint& endpoint);
  ~DomainUse();
  DomainUse(const DomainUse&) = delete;
  DomainUse& operator=(const DomainUse&) = delete;

 private:
  friend class Silence;
  std::uint32_t domain_;
};

/// While one exists, nothing that other processes send in the domain is received, and so nothing
/// more is acknowledged; reliable writers send it again afterwards. Several may exist at a time;
/// the last one to end ends the silence.
class Silence {
 public:
  explicit Silence(Participant& participant);
  ~Silence();
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  Participant::Impl& participant_;
};

/// Members are made in this order and deleted in the reverse one: the domain goes last.
struct Participant::Impl {
  explicit Impl(const Endpoint& endpoint);

  DomainUse domain;
  SessionKeeper sessions;
  std::optional<Silence> silence;  // between stop_hearing() and hear_again()
};

}  // namespace reident::dds
