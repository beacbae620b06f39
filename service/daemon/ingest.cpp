#include "service/daemon/ingest.hpp"

#include <chrono>

#include "service/support/allocator.hpp"
#include "service/support/log.hpp"

namespace reident {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t messages_at_most = 256;  // messages of one topic in a turn
constexpr std::size_t push_together = 64;      // the archive's thread is woken for so many at once

dds::ReaderOptions options_of(const Config& config) {
  dds::ReaderOptions options;
  options.max_frame_samples = config.max_frame_samples;
  return options;
}

void log_acknowledgement(const ModelAcknowledgement& acknowledgement) {
  if (acknowledgement.accepted)
    log::info("simulator",
              acknowledgement.running.version > 0 ? "runs a version" : "runs no version",
              {{"simulator", acknowledgement.simulator},
               {"equipment", acknowledgement.spacecraft + "/" + acknowledgement.equipment},
               {"version", acknowledgement.running.version}});
  else
    log::warning("simulator", "refused a version",
                 {{"simulator", acknowledgement.simulator},
                  {"equipment", acknowledgement.spacecraft + "/" + acknowledgement.equipment},
                  {"version", acknowledgement.version},
                  {"reason", acknowledgement.reason}});
}

template <class M>
void note_rejected(const dds::Reader<M>& reader, std::atomic<std::uint64_t>& count,
                   const char* what) {
  if (reader.malformed() == count) return;
  count = reader.malformed();
  log::warning("ingest", what, {{"reason", reader.last_malformed()}, {"refused", count.load()}});
}

}  // namespace

Ingest::Ingest(dds::Participant& participant, const Config& config,
               BoundedQueue<TelemetryEvent>& queue, SimulatorBook& simulators, Clock clock)
    : participant_(participant),
      queue_(queue),
      descriptors_(participant),
      frames_(participant, options_of(config)),
      acknowledgements_(participant),
      ready_(participant),
      simulators_(simulators),
      clock_(std::move(clock)) {
  for (const SpacecraftConfig& one : config.spacecraft) spacecraft_.insert(one.name);
  ready_.attach(descriptors_);
  ready_.attach(frames_);
  ready_.attach(acknowledgements_);
}

void Ingest::queue(storage::ParameterDescriptor&& descriptor) {
  queue(TelemetryEvent(std::move(descriptor)));
}

void Ingest::queue(storage::TelemetryFrame&& frame) {
  ++frames_received_;
  queue(TelemetryEvent(std::move(frame)));
}

void Ingest::queue(TelemetryEvent&& event) {
  taken_.push_back(std::move(event));
  if (taken_.size() >= push_together) push_taken();
}

void Ingest::push_taken() {
  if (taken_.empty()) return;
  waits_for_room_ = true;
  queue_.push(taken_);
  waits_for_room_ = false;
}

void Ingest::count_rejected() {
  note_rejected(frames_, frames_rejected_, "refused a telemetry frame");
  note_rejected(descriptors_, descriptors_rejected_,
                "refused a parameter descriptor; its sender has to correct it");
}

void Ingest::hear(const ModelAcknowledgement& acknowledgement) {
  // One of several spacecraft says in each one's partition what it runs of all.
  if (!spacecraft_.contains(acknowledgement.spacecraft)) return;
  if (simulators_.hear(acknowledgement, clock_())) log_acknowledgement(acknowledgement);
}

std::size_t Ingest::take() {
  came_round_ = true;
  std::size_t taken = descriptors_.take(
      messages_at_most, [this](storage::ParameterDescriptor&& one) { queue(std::move(one)); });
  taken += frames_.take(messages_at_most,
                        [this](storage::TelemetryFrame&& one) { queue(std::move(one)); });
  taken += acknowledgements_.take(
      messages_at_most, [this](ModelAcknowledgement&& message) { hear(message); }, {},
      [this](ModelAcknowledgement&& key) { simulators_.leave(key, clock_()); });
  push_taken();
  count_rejected();
  return taken;
}

void Ingest::watch_simulators() {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_look_) return;
  next_look_ = now + std::chrono::seconds(1);
  const std::uint32_t simulators = acknowledgements_.matched_writers();
  if (simulators >= listeners_ && std::exchange(are_leaving_, false)) return_freed_memory();
  if (simulators < listeners_) are_leaving_ = true;
  listeners_ = simulators;
}

void Ingest::run() {
  while (!stopping_) {
    ready_.wait(dds::idle_wait);
    while (take() > 0 && !stopping_) {
    }
    watch_simulators();
  }
  participant_.stop_hearing();
  descriptors_.drain([this](storage::ParameterDescriptor&& one) { queue(std::move(one)); });
  frames_.drain([this](storage::TelemetryFrame&& one) { queue(std::move(one)); });
  push_taken();
  count_rejected();
}

void Ingest::stop() {
  stopping_ = true;
  ready_.wake();
}

}  // namespace reident
