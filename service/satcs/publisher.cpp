#include "service/satcs/publisher.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <map>
#include <mutex>
#include <thread>
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

/// With what the cut of the network needs.
PublisherOptions settled(PublisherOptions options, std::size_t parameters) {
  if (options.cut.length.count() == 0) {
    if (!options.history) options.history = history_of_restarts(parameters);
    return options;
  }
  const dds::CutSettings settings = dds::settings_for(options.cut, parameters);
  options.endpoint.lease = settings.lease;
  options.endpoint.unacknowledged_bytes = settings.unacknowledged_bytes;
  if (!options.history) options.history = settings.history;
  return options;
}

/// One call of publish().
class Publication {
 public:
  Publication(FrameStream& stream, const PublisherOptions& options, const std::stop_token& stop)
      : stream_(stream),
        options_(settled(options, stream.parameters().size())),
        stop_(stop),
        participant_(options_.endpoint),
        descriptors_(participant_),
        frames_(participant_, {.history = *options_.history}),
        unheard_(static_cast<std::size_t>(*options_.history),
                 static_cast<std::size_t>(history_of_restarts(stream.parameters().size()))) {}

  PublisherSummary operator()() {
    const auto began = Clock::now();
    hearing_ = std::jthread([this](const std::stop_token& end) { hear_acknowledgments(end); });
    summary_.outcome = all();
    if (!readers_are_there()) unheard_.ended();
    summary_.lost = unheard_.lost();
    progress_.clear();
    for (const auto& [source, sender] : senders_) summary_.frames_missed += sender.unheard;
    warn_of_lost();
    summary_.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
    return summary_;
  }

 private:
  Outcome all();
  Outcome write_frames();
  Outcome wait_for_readers();
  Outcome wait_for_acknowledgments();
  bool readers_are_there() const;
  /// A thread's body: keeps `acknowledged_` true.
  void hear_acknowledgments(const std::stop_token& stop);
  void follow(const storage::TelemetryFrame& frame);
  /// Logs each hole once, when it has ended.
  void warn_of_lost();
  /// Stays for readers that join late; false when it was stopped.
  bool linger();
  void meet_late_archive();
  void count(const storage::TelemetryFrame& frame);
  void show_progress(const storage::TelemetryFrame& frame);

  FrameStream& stream_;
  const PublisherOptions options_;
  const std::stop_token& stop_;
  dds::Participant participant_;
  dds::Writer<storage::ParameterDescriptor> descriptors_;
  dds::Writer<storage::TelemetryFrame> frames_;
  UnheardFrames unheard_;
  std::atomic<std::uint64_t> written_ = 0, acknowledged_ = 0;  // frames
  std::size_t warned_ = 0;                                     // holes that the log has
  struct SenderState {
    Pacer pacer;                // of its own: their clocks may differ
    std::uint64_t unheard = 0;  // frames since an archive listened
  };
  std::map<std::string, SenderState, std::less<>> senders_;
  Progress progress_;
  PublisherSummary summary_;
  std::jthread hearing_;  // ends first
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
            {{"frames", summary_.frames}, {"history", *options_.history}});
  const auto until = Clock::now() + options_.linger;
  bool goes_on = true;
  while (goes_on && frames_.matched_archives() == 0 && Clock::now() < until)
    goes_on = sleep_until(std::min(until, Clock::now() + look_again), stop_);
  meet_late_archive();
  return goes_on && sleep_until(until, stop_);
}

void Publication::meet_late_archive() {
  if (frames_.matched_archives() == 0) return;
  for (auto& [source, sender] : senders_) {
    const auto kept = static_cast<std::uint64_t>(*options_.history);
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
    follow(frame);
    show_progress(frame);
  }
  return Outcome::complete;
}

Outcome Publication::wait_for_readers() {
  constexpr auto look_again = std::chrono::milliseconds(20);
  constexpr auto tell_again = std::chrono::minutes(1);
  constexpr auto discovery = std::chrono::seconds(2);  // of programs that are there
  const auto began = Clock::now();
  auto tell = began;
  bool looked = false;
  while (!stop_.stop_requested()) {
    const std::uint32_t readers = frames_.matched_readers();
    const std::uint32_t archives = frames_.matched_archives();
    if (readers >= options_.wait_readers && (archives > 0 || options_.wait_readers == 0))
      return Outcome::complete;
    if (options_.wait_timeout && Clock::now() - began >= *options_.wait_timeout) {
      return Outcome::no_readers;
    }
    if (Clock::now() >= tell) {
      progress_.clear();
      log::info(
          "satcs",
          "waiting for readers of the telemetry; reidentd on this domain and partition is one",
          {{"readers", readers},
           {"archives", archives},
           {"wanted", options_.wait_readers},
           {"domain", options_.endpoint.domain},
           {"partition", options_.endpoint.partition}});
      tell += tell_again;
    }
    if (!looked && Clock::now() - began >= discovery) {
      looked = true;
      if (participant_.misses_security())
        log::warning("satcs",
                     "the domain is secured, and this program has no certificate: nobody hears it; "
                     "name its folder with --security or REIDENT_SECURITY");
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
  if (readers_are_there()) unheard_.acknowledged(written_);
  return Outcome::complete;
}

// A reader that goes has acknowledged everything a moment before the middleware knows that it has
// gone: who is still there a little later was there.
void Publication::hear_acknowledgments(const std::stop_token& stop) {
  constexpr auto slice = std::chrono::milliseconds(100);
  constexpr auto farewell = std::chrono::milliseconds(50);
  try {
    while (!stop.stop_requested()) {
      const std::uint64_t frames = written_;
      const bool are_heard = readers_are_there() && frames_.wait_for_acknowledgments(slice);
      if (!sleep_until(Clock::now() + farewell, stop)) return;
      if (are_heard && readers_are_there()) acknowledged_ = frames;
    }
  } catch (const dds::Error&) {  // which the thread that writes meets too
  }
}

bool Publication::readers_are_there() const {
  return frames_.matched_readers() >= std::max(options_.wait_readers, 1U);
}

void Publication::follow(const storage::TelemetryFrame& frame) {
  const bool are_there = readers_are_there();
  unheard_.written(frame.generation_time, are_there);
  ++written_;
  if (!are_there) return;
  unheard_.acknowledged(acknowledged_);
  warn_of_lost();
}

void Publication::warn_of_lost() {
  const std::vector<LostFrames>& lost = unheard_.lost();
  for (; warned_ < lost.size(); ++warned_)
    log::warning("satcs",
                 "frames are lost: no reader was there, and the history was too short; a longer "
                 "--cut or --history keeps more",
                 {{"spacecraft", options_.spacecraft},
                  {"frames", lost[warned_].frames},
                  {"first_time", time_text(lost[warned_].first_time)},
                  {"last_time", time_text(lost[warned_].last_time)},
                  {"history", *options_.history}});
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
