// The thread between the middleware and the queue: it takes, checks, counts and copies; it never
// waits for the disk, only for room in the queue.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "service/config/config.hpp"
#include "service/daemon/archive_writer.hpp"
#include "service/daemon/bounded_queue.hpp"
#include "service/daemon/simulator_book.hpp"
#include "service/daemon/window_feed.hpp"
#include "service/dds/dds.hpp"

namespace reident {

class Ingest {
 public:
  /// What it is given must outlive it. Throws dds::Error.
  Ingest(dds::Participant& participant, const Config& config, BoundedQueue<TelemetryEvent>& queue,
         SimulatorBook& simulators, Clock clock);

  /// The thread's body: until stop(). What was acknowledged to the writers by then, so that they
  /// need not keep it, is still queued before it returns.
  void run();
  void stop();

  std::uint64_t frames_received() const { return frames_received_; }
  /// Frames and descriptors that broke the contract of their topic and were refused.
  std::uint64_t frames_rejected() const { return frames_rejected_; }
  /// Whether the thread came round since the last call, or the queue holds it back.
  bool goes_on() { return came_round_.exchange(false) || waits_for_room_; }
  std::uint64_t descriptors_rejected() const { return descriptors_rejected_; }

 private:
  /// Returns how many messages there were.
  std::size_t take();
  void queue(storage::ParameterDescriptor&& descriptor);
  void queue(storage::TelemetryFrame&& frame);
  void queue(TelemetryEvent&& event);
  /// Pushes what was taken; waits for room.
  void push_taken();
  /// Logs what was refused since the last call.
  void count_rejected();
  /// Once a second: what a hundred simulators leave behind is given back when they have left.
  void watch_simulators();
  /// Logs what is news: simulators repeat their running errors.
  void hear(const ModelAcknowledgement& acknowledgement);

  dds::Participant& participant_;
  BoundedQueue<TelemetryEvent>& queue_;
  dds::Reader<storage::ParameterDescriptor> descriptors_;
  dds::Reader<storage::TelemetryFrame> frames_;
  dds::Reader<ModelAcknowledgement> acknowledgements_;
  dds::WaitSet ready_;
  SimulatorBook& simulators_;
  std::set<std::string> spacecraft_;  // that are configured
  const Clock clock_;
  std::uint32_t listeners_ = 0;  // simulators at the last look
  bool are_leaving_ = false;
  std::chrono::steady_clock::time_point next_look_;
  std::vector<TelemetryEvent> taken_;  // and not pushed yet
  std::atomic<bool> stopping_ = false;
  std::atomic<std::uint64_t> frames_received_ = 0;
  std::atomic<std::uint64_t> frames_rejected_ = 0;
  std::atomic<bool> came_round_ = false, waits_for_room_ = false;
  std::atomic<std::uint64_t> descriptors_rejected_ = 0;
};

}  // namespace reident
