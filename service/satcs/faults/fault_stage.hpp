// One fault at work. Private to faults.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "service/satcs/faults/fault_kind.hpp"
#include "service/satcs/reference/random.hpp"

namespace reident::satcs {

/// A frame between the spacecraft and the archive.
struct Flight {
  storage::Time generated = 0;  // the true time on board
  storage::Time arrival = 0;    // the true time on the ground
  storage::TelemetryFrame frame;

  /// Moves the arrival; the station's clock keeps its error.
  void arrive_at(storage::Time time) {
    frame.reception_time += time - arrival;
    arrival = time;
  }
};

/// What one fault does to flights, in the order of their true times.
class FaultStage {
 public:
  virtual ~FaultStage() = default;
  /// Takes a flight that was generated in the fault's range and appends what becomes of it.
  virtual void pass(Flight&& flight, std::vector<Flight>& on) = 0;
};

/// Random numbers of one fault about one thing at one time, whatever was drawn before.
inline RandomStream draw(const Fault& fault, storage::Time time, std::uint32_t parameter = 0) {
  return {fault.seed ^ mix(static_cast<std::uint64_t>(fault.kind) + 1),
          mix(static_cast<std::uint64_t>(time)) ^ parameter};
}

/// Rounds to the nearest nanosecond.
inline storage::Time nanoseconds(double seconds) {
  return static_cast<storage::Time>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5));
}

/// Returns a fault about the samples of the parameters that it names; all of `parameters` where it
/// names none. Requires one without obstacle(), as the next.
std::unique_ptr<FaultStage> sample_fault(const Fault& fault,
                                         std::span<const storage::ParameterDescriptor> parameters);
/// Returns a fault about frames.
std::unique_ptr<FaultStage> frame_fault(const Fault& fault, const FaultInjectorOptions& options);

}  // namespace reident::satcs
