// One lie at work. Private to lies.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "service/satcs/faults/lie_kind.hpp"
#include "service/satcs/reference/random.hpp"

namespace reident::satcs {

/// A frame between the spacecraft and the archive.
struct Flight {
  storage::Time generated = 0;  // the true time on board
  storage::Time arrival = 0;    // the true time on the ground
  storage::TelemetryFrame frame;

  /// The station's clock keeps its error.
  void arrive_at(storage::Time time) {
    frame.reception_time += time - arrival;
    arrival = time;
  }
};

class LieStage {
 public:
  virtual ~LieStage() = default;
  /// Takes a flight that was generated in the lie's stretch and appends what becomes of it.
  virtual void pass(Flight&& flight, std::vector<Flight>& on) = 0;
};

/// Random numbers of one lie about one thing at one time, whatever was drawn before.
inline RandomStream draw(const Lie& lie, storage::Time time, std::uint32_t parameter = 0) {
  return {lie.seed ^ mix(static_cast<std::uint64_t>(lie.kind) + 1),
          mix(static_cast<std::uint64_t>(time)) ^ parameter};
}

inline storage::Time nanoseconds(double seconds) {
  return static_cast<storage::Time>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5));
}

/// A lie about the samples of parameters. `subjects` are the parameters that it names; all where it
/// names none.
std::unique_ptr<LieStage> sample_lie(const Lie& lie,
                                     std::span<const storage::ParameterDescriptor> parameters);
/// A lie about frames.
std::unique_ptr<LieStage> frame_lie(const Lie& lie, const LiarOptions& options);

}  // namespace reident::satcs
