// What a writer does whatever its message is: the entities of its session, and the way into the
// next one.
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <optional>

#include "service/dds/domain.hpp"
#include "service/dds/qos.hpp"

namespace reident::dds {

/// Follows the participant into its newest session, at a call or within a second. While sessions
/// overlap, states and questions go to the writers of both; telemetry goes to the old one until the
/// new one has found as many readers, and the old one stays until they have acknowledged it. One
/// thread at a time; calls throw Error.
class WriterCore final : public Follower {
 public:
  using Call = std::function<dds_return_t(dds_entity_t writer)>;

  WriterCore(Participant& participant, const Profile& profile,
             const dds_topic_descriptor_t& descriptor, const WriterOptions& options);
  /// Disposes of what was written, where the profile says so.
  ~WriterCore();
  WriterCore(const WriterCore&) = delete;
  WriterCore& operator=(const WriterCore&) = delete;

  /// Writes by `call`, again until it does not time out, or `stop` answers true: then false. `wire`
  /// is the sample's key; `again`, where it is given, writes the sample into the next session.
  bool write(const void* wire, const Call& call, const std::function<bool()>& stop,
             const Call& again);
  void dispose(const void* wire);
  std::uint32_t matched_readers() const;
  /// Those of them that keep all, as archives do.
  std::uint32_t matched_archives();
  bool wait_for_acknowledgments(std::chrono::nanoseconds timeout);
  /// Whether write() needs `again`: readers that join late get the sample, and sessions change.
  bool keeps_state() const;

  void follow() noexcept override;

 private:
  struct SessionWriter {
    SharedSession session;
    Entity topic;
    Entity writer;
  };

  SessionWriter make_writer(const SharedSession& session) const;
  void move_on() REIDENT_REQUIRES(mutex_);
  void join_newest() REIDENT_REQUIRES(mutex_);
  std::uint32_t matched(const SessionWriter& one) const;
  const SessionWriter& in_use() const REIDENT_REQUIRES(mutex_) {
    return before_ && !took_over_ ? *before_ : current_;
  }
  bool is_acknowledged(const SessionWriter& one, dds_duration_t timeout) const;
  /// Makes the call until it does not time out, or `stop` answers true: then false.
  bool insist(const char* what, const Call& call, const std::function<bool()>& stop);
  /// One attempt on each writer that is concerned.
  dds_return_t attempt(const Call& call) REIDENT_REQUIRES(mutex_);
  bool is_telemetry() const { return profile_.history == keep_all; }

  SessionKeeper& sessions_;
  const Profile& profile_;
  const dds_topic_descriptor_t& descriptor_;
  const WriterOptions options_;
  mutable Mutex mutex_;
  SessionWriter current_ REIDENT_GUARDED_BY(mutex_);
  std::optional<SessionWriter> before_ REIDENT_GUARDED_BY(mutex_);
  /// Whether telemetry goes to the new writer.
  bool took_over_ REIDENT_GUARDED_BY(mutex_) = true;
  std::chrono::steady_clock::time_point joined_ REIDENT_GUARDED_BY(mutex_);
  /// The archives of this writer, counted when so many readers had ever come and were there.
  struct Archives {
    dds_entity_t writer = 0;
    std::uint32_t ever = 0, now = 0;
    std::uint32_t count = 0;
  };
  Archives archives_ REIDENT_GUARDED_BY(mutex_);
  SharedSession refused_ REIDENT_GUARDED_BY(mutex_);  // one that denies the topic
  /// By instance: what readers of the next session get.
  std::map<dds_instance_handle_t, std::deque<Call>> kept_ REIDENT_GUARDED_BY(mutex_);
};

}  // namespace reident::dds
