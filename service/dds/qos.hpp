// Every QoS profile. idl/README.md says why each is as it is.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include <dds/dds.h>

#include "service/dds/dds.hpp"

namespace reident::dds {

/// A QoS object of the middleware, owned.
struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

/// In place of a number of samples: none is replaced by a newer one.
inline constexpr std::int32_t keep_all = 0;

/// What differs between the topics. All are RELIABLE and in the participant's partition. A KEEP_ALL
/// writer whose readers are full waits until there is room, however long that takes; a KEEP_LAST
/// writer replaces what is old, and gives up after `patience` where even that is not possible.
struct Profile {
  const char* topic;
  std::int32_t history;       // samples kept of an instance, or keep_all
  std::int32_t late_joiners;  // the same for readers that join late; with keep_all the writer's
                              // options say how many; 0 makes the topic VOLATILE
  /// The instances of a writer that ends are disposed of. False where what was said last stays
  /// true without its writer.
  bool autodispose;
  /// How long a sample may wait for readers that do not take it; 0: for ever. What such a reader
  /// holds back counts against the bound of what a writer keeps for all of them.
  std::chrono::milliseconds lifespan{0};
  /// Above 0: of several writers of a key the one with the greatest strength is heard alone
  /// (EXCLUSIVE), until it has written nothing for so long (MANUAL_BY_TOPIC).
  std::chrono::milliseconds lease{0};
};

inline constexpr Profile telemetry_frame{"satcs/TelemetryFrame", keep_all, keep_all, false};
inline constexpr Profile parameter_descriptor{"satcs/ParameterDescriptor", 1, 1, false};
inline constexpr Profile model_version{"reident/ModelVersion", 1, 1, false};
inline constexpr Profile identification_report{"reident/IdentificationReport", 64, 64, false};
inline constexpr Profile model_acknowledgement{"reident/ModelAcknowledgement", 1, 1, true};
inline constexpr Profile service_status{"reident/ServiceStatus", 1, 1, true};
inline constexpr Profile command_request{"reident/Command", 1, 0, true};
inline constexpr Profile command_reply{"reident/CommandReply", 1, 0, true};
inline constexpr Profile history_request{"reident/HistoryRequest", 1, 0, false};
inline constexpr Profile history_reply{"reident/HistoryReply", 1, 0, false,
                                       std::chrono::milliseconds(500)};

inline constexpr Profile leadership{"reident/Leadership", 1, 1, true, std::chrono::milliseconds(0),
                                    leadership_lease};
inline constexpr Profile replica{"reident/Replica", 16, 0, true, std::chrono::milliseconds(500)};

/// The middleware's blocking time of one attempt to write: how soon a stop request is seen.
inline constexpr std::chrono::milliseconds write_slice{100};
/// How long a KEEP_LAST writer tries.
inline constexpr std::chrono::seconds patience{10};

/// Returns the QoS of a publisher and a subscriber. All three functions throw std::bad_alloc alone.
Qos partition_qos(const std::string& partition);
/// Returns the QoS of a writer; `options.history` counts for KEEP_ALL topics alone.
Qos writer_qos(const Profile& profile, const WriterOptions& options);
/// Returns the QoS of a reader. `transient_local`: whether history of writers that keep some is
/// asked for; such a reader does not match a volatile writer. The bounds of `options` count for
/// KEEP_ALL topics alone.
Qos reader_qos(const Profile& profile, const ReaderOptions& options, bool transient_local);

}  // namespace reident::dds
