#include "service/satcs/publisher.hpp"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <mutex>

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
        frames_(participant_, {.history = options.history.value_or(
                                   history_of_restarts(stream.parameters().size()))}) {}

  PublisherSummary operator()() {
    const auto began = Clock::now();
    summary_.outcome = all();
    progress_.clear();
    summary_.wall_s = std::chrono::duration<double>(Clock::now() - began).count();
    return summary_;
  }

 private:
  Outcome all();
  Outcome write_frames();
  Outcome wait_for_readers();
  Outcome wait_for_acknowledgments();
  void count(const storage::TelemetryFrame& frame);
  void show_progress(const storage::TelemetryFrame& frame);

  FrameStream& stream_;
  const PublisherOptions& options_;
  const std::stop_token& stop_;
  dds::Participant participant_;
  dds::Writer<storage::ParameterDescriptor> descriptors_;
  dds::Writer<storage::TelemetryFrame> frames_;
  std::map<std::string, Pacer, std::less<>> pacers_;  // by sender: their clocks may differ
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
  if (options_.linger.count() == 0) return Outcome::complete;
  // A stop ends the linger early and takes nothing from what was delivered.
  if (!sleep_until(Clock::now() + options_.linger, stop_)) return Outcome::complete;
  return wait_for_acknowledgments();
}

Outcome Publication::write_frames() {
  storage::TelemetryFrame frame;
  if (const Outcome outcome = wait_for_readers(); outcome != Outcome::complete) return outcome;
  while (stream_.next(frame)) {
    frame.spacecraft = options_.spacecraft;
    const auto now = Clock::now();
    const auto due = pacers_.try_emplace(frame.source, options_.speed)
                         .first->second.due(frame.reception_time, now);
    if (due > now) sleep_until(due, stop_);
    if (const Outcome outcome = wait_for_readers(); outcome != Outcome::complete) return outcome;
    if (!frames_.write(frame, [this] { return stop_.stop_requested(); })) return Outcome::stopped;
    count(frame);
    show_progress(frame);
  }
  return Outcome::complete;
}

Outcome Publication::wait_for_readers() {
  constexpr auto look_again = std::chrono::milliseconds(20);
  constexpr auto discovery = std::chrono::seconds(2);  // of programs that are there
  const auto began = Clock::now();
  bool told = false, looked = false;
  while (!stop_.stop_requested()) {
    const std::uint32_t readers = frames_.matched_readers();
    if (readers >= options_.wait_readers) return Outcome::complete;
    if (options_.wait_timeout && Clock::now() - began >= *options_.wait_timeout) {
      return Outcome::no_readers;
    }
    if (!told) {
      progress_.clear();
      log::info("satcs", "waiting for readers of the telemetry",
                {{"readers", readers},
                 {"wanted", options_.wait_readers},
                 {"domain", options_.endpoint.domain},
                 {"partition", options_.endpoint.partition}});
      told = true;
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
