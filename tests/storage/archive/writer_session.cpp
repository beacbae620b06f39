#include "tests/storage/archive/writer_session.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "storage/database/connection.hpp"
#include "tests/storage/fixture.hpp"

namespace reident::storage::test {
namespace {

constexpr std::uint64_t frames_of_batch = 8;
constexpr std::uint64_t frames_of_cycle = 5 * frames_of_batch;  // of the station, in order
constexpr std::uint32_t parameters = 6;
constexpr Time period = 1'000'000'000;

// Steps, a slow drift, a constant, noise, and what is no number.
double value_of(std::uint32_t parameter, std::uint64_t frame) {
  switch (parameter) {
    case 0:
      return static_cast<double>(frame / 7 % 3);
    case 1:
      return 28 + static_cast<double>(frame) * 1e-3;
    case 2:
      return -0.0;
    case 3:
      return frame % 11 == 0 ? std::nan("") : std::sin(static_cast<double>(frame));
    case 4:
      return frame % 13 == 0 ? std::numeric_limits<double>::infinity() : 4.5;
    default:
      return static_cast<double>((frame * 2654435761U) % 4096) / 16;
  }
}

TelemetryFrame station_frame(std::uint64_t number, Quality quality = Quality::suspect,
                             double offset = 0) {
  TelemetryFrame one = frame(number, static_cast<Time>(number) * period, {});
  for (std::uint32_t p = 0; p < parameters; ++p)
    one.samples.push_back({p, quality, value_of(p, number) + offset});
  return one;
}

std::vector<TelemetryFrame> station_frames(std::uint64_t first, std::uint64_t count) {
  std::vector<TelemetryFrame> frames;
  for (std::uint64_t i = 0; i < count; ++i) frames.push_back(station_frame(first + i));
  return frames;
}

/// What was recorded on board before the first frame of the station, played backwards; in
/// between what the station receives meanwhile.
std::vector<TelemetryFrame> with_playback(std::vector<TelemetryFrame> frames, std::uint64_t cycle) {
  constexpr std::uint64_t last_sequence = 1'000'000;
  for (std::uint64_t i = 0; i < frames_of_batch; ++i) {
    const std::uint64_t back = cycle * frames_of_batch + i;
    TelemetryFrame played = station_frame(back);
    played.source = "playback";
    played.sequence = last_sequence - back;
    played.generation_time = -static_cast<Time>(back + 1) * period;
    frames.insert(frames.begin() + static_cast<std::ptrdiff_t>(2 * i), std::move(played));
  }
  return frames;
}

std::vector<TelemetryFrame> with_simulator(std::vector<TelemetryFrame> frames) {
  for (std::size_t i = 0, count = frames.size(); i < count; ++i) {
    frames.push_back(frames[i]);
    frames.back().source = "simulator";
    frames.back().origin = Origin::simulated;
  }
  return frames;
}

/// Frames of which some are known, some are new, some contradict with a better quality and some
/// with a worse one.
std::vector<TelemetryFrame> repeated(std::uint64_t first) {
  std::vector<TelemetryFrame> frames = station_frames(first, 3);
  frames.push_back(station_frame(first + 3, Quality::good, 0.25));
  frames.push_back(station_frame(first + 4, Quality::invalid, 0.5));
  frames.push_back(station_frame(first + 5, Quality::good));
  return frames;
}

std::vector<TelemetryFrame> frames_at(std::uint64_t cycle, std::uint64_t step) {
  const std::uint64_t begin = cycle * frames_of_cycle;
  const auto in_order = [&](std::uint64_t batch) {
    return station_frames(begin + batch * frames_of_batch, frames_of_batch);
  };
  std::vector<TelemetryFrame> frames;
  switch (step) {
    case 0:  // one is missing and comes late, one never comes
      frames = in_order(0);
      frames.erase(frames.begin() + 5);
      frames.erase(frames.begin() + 2);
      return frames;
    case 1:
      return in_order(1);
    case 2:
      return {station_frame(begin + 2)};
    case 3:
      return with_playback(in_order(2), cycle);
    case 4:
      return repeated(begin + frames_of_batch);
    case 6:
      return in_order(3);
    case 7:  // into what was compacted cycles ago
      return repeated(cycle / 2 * frames_of_cycle + 2 * frames_of_batch);
    default:
      return with_simulator(in_order(4));
  }
}

}  // namespace

Step step_at(std::uint64_t number) {
  const std::uint64_t step = number % steps_of_cycle;
  switch (step) {
    case 5:
      return {StepKind::compact, {}};
    case 8:
      return {StepKind::checkpoint, {}};
    case 11:
      return {StepKind::reopen, {}};
    default:
      return {StepKind::append, frames_at(number / steps_of_cycle, step)};
  }
}

void carry_out_steps(const std::filesystem::path& path, Durability durability, std::uint64_t first,
                     std::uint64_t end, const std::function<void(std::uint64_t)>& begins,
                     const std::function<void(std::uint64_t)>& done) {
  std::optional<Database> database;
  for (std::uint64_t number = first; number < end; ++number) {
    begins(number);
    if (!database) database.emplace(path, Database::Mode::read_write, durability);
    Archive archive(*database, session_options);
    const Step step = step_at(number);
    switch (step.kind) {
      case StepKind::append:
        archive.append(step.frames);
        break;
      case StepKind::compact:
        archive.compact();
        break;
      case StepKind::checkpoint:
        database->impl().connection->execute("PRAGMA wal_checkpoint(TRUNCATE)");
        break;
      case StepKind::reopen:
        database.reset();
        break;
    }
    done(number);
  }
}

}  // namespace reident::storage::test
