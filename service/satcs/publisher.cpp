#include "service/satcs/publisher.hpp"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "service/satcs/pacer.hpp"
#include "service/support/log.hpp"
#include "service/support/progress.hpp"
#include "service/support/time_text.hpp"

namespace reident::satcs {
namespace {

using Clock = std::chrono::steady_clock;

/// False when it was cut short by a stop.
bool sleep_until(Clock::time_point until, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any condition;
  std::unique_lock lock(mutex);
  condition.wait_until(lock, stop, until, [] { return false; });
  return !stop.stop_requested();
}

/// The middleware holds a writer back when 500 kB are on the way to its readers (its default
/// Internal/Watermarks/WhcHigh). Four times as much leaves room for what is written before the
/// writer learns that its last reader left.
std::int32_t history_of_restarts(std::size_t parameters) {
  constexpr std::size_t kept_bytes = 2'000'000;
  constexpr std::size_t bytes_of_a_frame = 60;  // without samples, at the least
  constexpr std::size_t bytes_of_a_sample = 20;
  return static_cast<std::int32_t>(kept_bytes /
                                   (bytes_of_a_frame + bytes_of_a_sample * parameters)) +
         1;
}

/// One call of publish().
class Publication {
 public:
  Publication(FrameStream& stream, const PublisherOptions& options, const std::stop_token& stop)
      : stream_(stream),
        options_(options),
        stop_(stop),
        participant_(options.endpoint),
        descriptors_(participant_),
        history_(options.history.value_or(history_of_restarts(stream.parameters().size()))),
        frames_(participant_, {.history = history_}) {}

  PublisherSummary operator()() {
    const auto began = Clock::now();
    summary_.outcome = all();
    progress_.clear();
    for (const auto& [source, sender] : senders_) summary_.frames_missed += sender.unheard;
    summary_.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
    return summary_;
  }

 private:
  Outcome all();
  Outcome write_frames();
  Outcome wait_for_readers();
  Outcome wait_for_acknowledgments();
  /// Stays for readers that join late; false when it was stopped.
  bool linger();
  void meet_late_archive();
  void count(const storage::TelemetryFrame& frame);
  void show_progress(const storage::TelemetryFrame& frame);

  FrameStream& stream_;
  const PublisherOptions& options_;
  const std::stop_token& stop_;
  dds::Participant participant_;
  dds::Writer<storage::ParameterDescriptor> descriptors_;
  std::int32_t history_;
  dds::Writer<storage::TelemetryFrame> frames_;
  struct SenderState {
    Pacer pacer;                // of its own: their clocks may differ
    std::uint64_t unheard = 0;  // frames since an archive listened
  };
  std::map<std::string, SenderState, std::less<>> senders_;
  Progress progress_;
  PublisherSummary summary_;
};

Outcome Publication::all() {
  for (auto descriptor : stream_.parameters()) {
    descriptor.spacecraft = options_.spacecraft;
    descriptors_.write(descriptor);
    ++summary_.parameters;
  }
  if (const Outcome outcome = write_frames(); outcome != Outcome::complete) return outcome;
  if (const Outcome outcome = wait_for_acknowledgments(); outcome != Outcome::complete) {
    return outcome;
  }
  // A stop ends the linger early and takes nothing from what was delivered.
  if (!linger()) return Outcome::complete;
  return wait_for_acknowledgments();
}

bool Publication::linger() {
  constexpr auto look_again = std::chrono::milliseconds(100);
  if (options_.linger.count() == 0) return true;
  log::info("satcs", "every frame is written; staying for readers that join late",
            {{"frames", summary_.frames}, {"history", history_}});
  const auto until = Clock::now() + options_.linger;
  while (frames_.matched_archives() == 0 && Clock::now() < until)
    if (!sleep_until(std::min(until, Clock::now() + look_again), stop_)) return false;
  meet_late_archive();
  return sleep_until(until, stop_);
}

void Publication::meet_late_archive() {
  if (frames_.matched_archives() == 0) return;
  for (auto& [source, sender] : senders_) {
    const auto kept = static_cast<std::uint64_t>(history_);
    if (const std::uint64_t unheard = std::exchange(sender.unheard, 0); unheard > kept) {
      summary_.frames_missed += unheard - kept;
      progress_.clear();
      log::warning("satcs", "an archive came late; frames had left the history and it misses them",
                   {{"source", source}, {"missed", unheard - kept}, {"history", kept}});
    }
  }
}

Outcome Publication::write_frames() {
  storage::TelemetryFrame frame;
  if (const Outcome outcome = wait_for_readers(); outcome != Outcome::complete) return outcome;
  while (stream_.next(frame)) {
    frame.spacecraft = options_.spacecraft;
    const auto now = Clock::now();
    SenderState& sender =
        senders_.try_emplace(frame.source, SenderState{Pacer(options_.speed)}).first->second;
    const auto due = sender.pacer.due(frame.reception_time, now);
    if (due > now) sleep_until(due, stop_);
    if (const Outcome outcome = wait_for_readers(); outcome != Outcome::complete) return outcome;
    meet_late_archive();
    if (!frames_.write(frame, [this] { return stop_.stop_requested(); })) return Outcome::stopped;
    if (frames_.matched_archives() == 0) ++sender.unheard;
    count(frame);
    show_progress(frame);
  }
  return Outcome::complete;
}

Outcome Publication::wait_for_readers() {
  constexpr auto look_again = std::chrono::milliseconds(20);
  const auto began = Clock::now();
  bool told = false;
  while (!stop_.stop_requested()) {
    const std::uint32_t readers = frames_.matched_readers();
    const std::uint32_t archives = frames_.matched_archives();
    if (readers >= options_.wait_readers && (archives > 0 || options_.wait_readers == 0))
      return Outcome::complete;
    if (options_.wait_timeout && Clock::now() - began >= *options_.wait_timeout) {
      return Outcome::no_readers;
    }
    if (!told) {
      progress_.clear();
      log::info("satcs", "waiting for readers of the telemetry",
                {{"readers", readers},
                 {"archives", archives},
                 {"wanted", options_.wait_readers},
                 {"domain", options_.endpoint.domain},
                 {"partition", options_.endpoint.partition}});
      told = true;
    }
    sleep_until(Clock::now() + look_again, stop_);
  }
  return Outcome::stopped;
}

Outcome Publication::wait_for_acknowledgments() {
  constexpr auto slice = std::chrono::milliseconds(100);
  const auto began = Clock::now();
  while (!descriptors_.wait_for_acknowledgments(slice) ||
         !frames_.wait_for_acknowledgments(slice)) {
    if (stop_.stop_requested()) return Outcome::stopped;
    if (options_.wait_timeout && Clock::now() - began >= *options_.wait_timeout) {
      return Outcome::not_acknowledged;
    }
  }
  return Outcome::complete;
}

void Publication::count(const storage::TelemetryFrame& frame) {
  if (summary_.frames == 0) {
    summary_.first_sequence = frame.sequence;
    summary_.first_time = frame.generation_time;
  }
  summary_.last_sequence = frame.sequence;
  summary_.last_time = frame.generation_time;
  ++summary_.frames;
  summary_.samples += frame.samples.size();
  summary_.invalid_samples += static_cast<std::uint64_t>(std::count_if(
      frame.samples.begin(), frame.samples.end(),
      [](const storage::Sample& sample) { return sample.quality == storage::Quality::invalid; }));
}

void Publication::show_progress(const storage::TelemetryFrame& frame) {
  if (!progress_.due()) return;
  progress_.update(stream_.progress(),
                   fmt::format("{} frames, {}", summary_.frames, time_text(frame.generation_time)));
}

}  // namespace

std::string_view name(Outcome outcome) {
  switch (outcome) {
    case Outcome::complete:
      return "complete";
    case Outcome::stopped:
      return "stopped";
    case Outcome::no_readers:
      return "no_readers";
    case Outcome::not_acknowledged:
      return "not_acknowledged";
  }
  return "";
}

PublisherSummary publish(FrameStream& stream, const PublisherOptions& options,
                         const std::stop_token& stop) {
  return Publication(stream, options, stop)();
}

}  // namespace reident::satcs
