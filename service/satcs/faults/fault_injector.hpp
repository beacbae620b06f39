// What telemetry goes through between a spacecraft's sensors and its archive, and the faults of its
// sensors.
//
// A FaultInjector takes true frames and hands out what the ground receives. Each fault is confined
// to a range of true time: frames generated outside it stay as they are to the last bit, and what
// a fault does depends on its seed and the frame alone. Faults take effect in the order in which
// they are given, each on what the ones before it left; a frame's true time stays its own through
// all of them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "service/satcs/family.hpp"
#include "service/satcs/reference/reference_life.hpp"
#include "storage/types/telemetry.hpp"

namespace reident::satcs {

/// Span is high limit - low limit of the parameter's descriptor, 1 where it has none. Readings of a
/// faulty sensor stay within those limits, as its converter's do, but for a magnitude of `stuck`.
enum class FaultKind : std::uint8_t {
  // Faults of one sensor. Magnitude in the parameter's unit.
  stuck,          // reads the magnitude; by default its first reading in the range
  bias_step,      // reads the magnitude more; 2 % of the span
  drifting_bias,  // reads more and more, at the end the magnitude; 5 % of the span
  noise_burst,    // white noise with the magnitude as standard deviation; 2 % of the span
  spikes,         // 1 % of the readings are off by the magnitude, up or down; 20 % of the span
  // Faults of one parameter, on board or on the ground.
  swapped,            // its readings come as those of the other, and the other's as its own
  wrong_calibration,  // magnitude: the gain, 1.05; the offset keeps the middle of the limits right
  stops,              // is sent no more
  // Magnitude: share of the samples, 0.2. Half of them are right and flagged invalid; the others
  // are flagged good and are anything within the limits. All parameters where none is named.
  wrong_validity,
  // Faults of frames.
  frames_lost,  // magnitude: the share that is lost, 0.1
  // Frames in ground contact come at once, the others with the next pass, at 256 times their rate
  // or, should that come first, at the end of the range. Magnitude: the share of the passes that
  // is lost, with what was on board until then, 0.3.
  passes_lost,
  // Nothing comes until the end of the range and then its frames, the last one first, at 8 times
  // their rate. Magnitude: how long after the end that begins [s], 600.
  backwards_playback,
  // The first station hears the first two thirds of every 600 s and a second one, source
  // "<source>-2", the last two. Numbers are those of the spacecraft's counter. Magnitude: how far
  // the second station's clock is ahead [s], 0.4; it stamps the reception.
  two_stations,
  two_stamping_stations,  // the same where stations stamp the generation time also
  time_jump,              // generation times are off by the magnitude [s], 3600
  duplicated_day,         // everything comes again so many seconds later, stamped so: 86,400
  repeated_day,           // everything comes again so many seconds later, as it was: 86,400
  // The hand-written simulator, begun with the range, sends its samples with origin real and
  // source "simulator", each frame just before the spacecraft's own. No magnitude.
  simulated_as_real,
};
inline constexpr std::size_t fault_kinds =
    static_cast<std::size_t>(FaultKind::simulated_as_real) + 1;

/// "stuck", ...
std::string_view name(FaultKind kind);
/// "stuck, bias_step, ...".
std::string fault_kind_names();

/// One fault of telemetry. Valid where obstacle() finds nothing.
struct Fault {
  FaultKind kind = FaultKind::stuck;
  storage::TimeRange when;          // of the true generation time
  std::string parameter;            // where the fault is of one
  std::string other;                // swapped with
  std::optional<double> magnitude;  // absent: the kind's default
  std::uint64_t seed = 0;
};

/// Why a fault cannot be.
struct FaultError {
  std::string message;  // what is wrong and what would mend it
};

/// "KIND@FROM/TO[:PARAMETER[,OTHER]][*MAGNITUDE][#SEED]". FROM and TO are times or, with a plus
/// sign, durations after `start`; `seed` is that of a text without one.
std::variant<Fault, FaultError> parse_fault(std::string_view text, storage::Time start,
                                            std::uint64_t seed = 0);

/// What keeps `fault` from being applied to these parameters; nothing where it can be.
std::optional<FaultError> obstacle(const Fault& fault,
                                   std::span<const storage::ParameterDescriptor> parameters);

/// What a FaultInjector must know of the spacecraft: its passes, and what its simulator would say.
struct FaultInjectorOptions {
  reference::Constants constants;
  std::vector<reference::LifeEvent> life;
  std::uint64_t seed = 1;  // of the operations plan
  Family family = Family::power;
};

/// One thread at a time. Its memory is that of the frames on their way: those of a range, where a
/// fault holds them back.
class FaultInjector {
 public:
  /// Throws std::invalid_argument with the message of the first obstacle.
  FaultInjector(std::span<const Fault> faults,
                std::span<const storage::ParameterDescriptor> parameters,
                const FaultInjectorOptions& options = {});
  ~FaultInjector();
  FaultInjector(FaultInjector&&) noexcept;
  FaultInjector& operator=(FaultInjector&&) noexcept;

  /// Takes the next true frame; generation times ascend. Appends what the ground has received by
  /// that time, in the order of reception.
  void take(storage::TelemetryFrame&& frame, std::vector<storage::TelemetryFrame>& received);
  /// Appends what is still on its way, in the order of reception; call once, behind the last frame.
  void flush(std::vector<storage::TelemetryFrame>& received);

 private:
  class Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace reident::satcs
