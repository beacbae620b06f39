// Typed, owning access to the topics of idl/README.md. No DDS type shows here.
//
// M is one of storage::TelemetryFrame, storage::ParameterDescriptor, ModelVersion,
// IdentificationReport, ModelAcknowledgement, ServiceStatus, CommandRequest, CommandReply,
// HistoryRequest, HistoryReply, Leadership and Replica; the topic, its key and its QoS follow from
// it (service/dds/qos.hpp has every profile).
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "service/model/messages.hpp"
#include "service/model/model_version.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::security {
struct Material;
}

namespace reident::dds {

/// A call to the middleware failed; says which, on what topic, and what would mend it.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Where a program takes part.
struct Endpoint {
  std::uint32_t domain = 0;              // 0 to 230
  std::string partition = "operations";  // separates operations, training and test
  /// Folder of a member's files (service/security/material.hpp); empty: the domain is not secured.
  std::filesystem::path security{};
  /// One of many that look for services, sources and consoles and not for each other: on loopback
  /// it takes a port of its own range. A domain's first participant in a process decides for all.
  bool simulator = false;
  /// For a network that may be cut (network_cut.hpp): how long others count on this participant
  /// without hearing it, and bytes that may wait for acknowledgement; 0: as the middleware has it.
  std::chrono::nanoseconds lease{0};
  std::uint64_t unacknowledged_bytes = 0;
};

/// Joins a domain. Without CYCLONEDDS_URI in the environment all traffic stays on 127.0.0.1. Must
/// outlive its readers, writers and wait sets. Any number of threads may make these at the same
/// time.
///
/// A secured one looks at its files each second. What changed is taken up while it runs: it joins
/// again with the new files, its readers and writers follow, and some seconds later it leaves with
/// the old ones. A state that was written comes again; reliable topics lose nothing. Files that are
/// wrong are not taken up, and the log says why, as it does of a certificate that ends.
class Participant {
 public:
  /// Throws Error where the domain is not one, or this machine has no port left in it
  /// (idl/README.md, "On a private network"), or the files of its security are wrong: all that is.
  explicit Participant(const Endpoint& endpoint);
  ~Participant();
  Participant(Participant&&) noexcept;
  Participant& operator=(Participant&&) noexcept;

  /// From here on nothing that other processes send is received, by any participant of this process
  /// in the domain, and so nothing more is acknowledged: reliable writers keep it for the next run.
  void stop_hearing();
  /// Ends that. Readers that still exist then go on.
  void hear_again();

  /// The files that were taken up last; null where the domain is not secured. From any thread, as
  /// the next.
  std::shared_ptr<const security::Material> material() const;
  /// What somebody has to see to: files that end within 30, 7 or 1 days or have ended, or that were
  /// changed and are wrong. Empty where there is nothing.
  std::string security_warning() const;
  /// Whether programs of reident were discovered that are secured, while this one is not: they hear
  /// nothing of it, nor it of them. Discovery takes some 100 ms.
  bool misses_security() const;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// How much telemetry a writer keeps for services that join late or restart, in frames of one
/// source.
struct WriterOptions {
  std::int32_t history = 1;   // used for TelemetryFrame alone; 0 keeps nothing for late joiners
  std::int32_t strength = 0;  // used for Leadership alone: the strongest writer is heard
};

/// Writes one topic. One thread at a time, but for the last two calls: it keeps the buffers of its
/// last message. Its end disposes of what it wrote where the topic's profile says so.
template <class M>
class Writer {
 public:
  /// Throws Error where the topic exists with another type, or memory is short.
  explicit Writer(Participant& participant, const WriterOptions& options = {});
  ~Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;

  /// Telemetry blocks while the readers' bounds are reached, so that nothing is lost; other topics
  /// give up after 10 s. Throws Error.
  void write(const M& message);
  /// Writes too, but asks `stop` several times a second while it blocks. False when it stopped:
  /// then the message was not written (a reader in this process that was full may find it missing,
  /// those in other processes may have it).
  bool write(const M& message, const std::function<bool()>& stop);
  /// Says that what was written for the message's key holds no more: readers that join later get
  /// nothing for it. Throws Error.
  void dispose(const M& message);
  /// Readers that are matched now, in this process and others.
  std::uint32_t matched_readers() const;
  /// Those of them that keep all (KEEP_ALL), as archives do: they make a writer wait rather than
  /// lose anything.
  std::uint32_t matched_archives() const;
  /// False when `timeout` passed before every matched reader had everything.
  bool wait_for_acknowledgments(std::chrono::nanoseconds timeout);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Why a receiver would refuse the message (idl/README.md, "What a receiver refuses"); absent where
/// it would not. M is TelemetryFrame or ParameterDescriptor.
template <class M>
std::optional<std::string> refusal(const M& message);

/// Bounds of what a reader keeps before it is taken, and of what it accepts.
struct ReaderOptions {
  std::int32_t max_samples = 4096;        // KEEP_ALL topics; writers wait when it is reached
  std::size_t max_frame_samples = 65536;  // a TelemetryFrame with more is refused and counted
  /// KEEP_ALL topics: above 0 the reader keeps so many of the newest messages of each instance and
  /// loses older ones rather than make a writer wait; for programs that may not slow the source.
  std::int32_t keep_last = 0;
};

/// Reads one topic, from writers that keep history and from those that keep none. One thread at a
/// time, but for malformed() and last_malformed(). Calls throw Error where the middleware fails.
/// The end of a reader of a KEEP_ALL topic first empties it, which takes a second at most.
template <class M>
class Reader {
 public:
  explicit Reader(Participant& participant, const ReaderOptions& options = {});
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  using Sink = std::function<void(M&&)>;
  /// Also takes when the message was sent, by its writer's clock; 0 where that is not known.
  using DatedSink = std::function<void(M&&, storage::Time sent)>;
  /// A malformed message, filled in as far as it could be read, and what is wrong with it.
  using Refused = std::function<void(const M&, const std::string& reason)>;

  /// Calls `sink` for each message taken, at most `max`, and `refused` for each malformed one;
  /// returns how many were taken, malformed ones included. Both are called on this thread, before
  /// take() returns; neither may throw. Does not wait: 0 where there is nothing.
  std::size_t take(std::size_t max, const Sink& sink, const Refused& refused = {});
  std::size_t take(std::size_t max, const DatedSink& sink, const Refused& refused = {});
  /// Also calls `ended` where nobody writes a key any more: its writer disposed of it or is gone.
  /// Such a message has its key alone.
  std::size_t take(std::size_t max, const Sink& sink, const Refused& refused, const Sink& ended);
  /// For a clean stop, after Participant::stop_hearing(): hands out every message that was
  /// acknowledged to its writer, those included that the middleware has not handed on yet. Takes
  /// until nothing came for 150 ms, a second at most. Returns how many were taken.
  std::size_t drain(const Sink& sink, const Refused& refused = {});
  /// Writers that are matched now, in this process and others.
  std::uint32_t matched_writers() const;
  /// Messages that broke the contract (sizes, ranges, strings) and were not handed out, and why
  /// the last of them was. From any thread.
  std::uint64_t malformed() const;
  std::string last_malformed() const;

 private:
  friend class WaitSet;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Whoever leads a pair says so within this time, or leads no more.
inline constexpr std::chrono::milliseconds leadership_lease{1000};

/// How long a thread that hears nothing waits before it shows that it comes round; data and wake()
/// end the wait earlier. A hundred idle services of a machine wake up so often each.
inline constexpr std::chrono::seconds idle_wait{2};

/// Wakes one thread when any attached reader has something to take, or when woken. Readers may end
/// before it.
class WaitSet {
 public:
  explicit WaitSet(Participant& participant);
  ~WaitSet();
  WaitSet(const WaitSet&) = delete;
  WaitSet& operator=(const WaitSet&) = delete;

  /// Not while another thread waits.
  template <class M>
  void attach(Reader<M>& reader);
  /// True when something was ready, which may be nothing to take; false when `timeout` passed.
  /// Throws Error.
  bool wait(std::chrono::nanoseconds timeout);
  /// From any thread: ends the running or the next wait.
  void wake();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace reident::dds
