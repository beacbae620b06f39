// Sensors that do not speak of the equipment for a while, told from their own samples: stuck,
// spikes, bursts of noise.
//
// What is unusual is measured against the rest of the same rows, with the rows of all channels side
// by side, since what the equipment does shows in more than one sensor:
//
//   stuck  one value is repeated exactly over a stretch that is at least 60 rows and 5 times as
//          long as the fourth longest of the channel, while another channel moves. A value that is
//          repeated for at least a third as long elsewhere (a regulated voltage), and the least and
//          greatest of the rows (an array in eclipse, a switched-off load), are no fault.
//   spike  a value that stands at least 20 times the usual step (its median), and a twentieth of
//          the channel's range, above or below both neighbours, which agree with each other to 0.3
//          of that; while no other analog channel jumps by 20 times its own step and a twentieth of
//          its range, and no digital one changes (a load that is on for a moment, a bus that gives
//          way as the array comes or goes). Hampel's rule for a window of three (F. R. Hampel, "The
//          influence curve and its role in robust estimation", Journal of the American Statistical
//          Association 69, 1974). More than 2 % of a channel's samples are its nature.
//   noise  over at least three blocks of 60 rows the trimmed mean of |x[t] - (x[t-1] + x[t+1]) / 2|
//          is 4 times its third quartile over all blocks, and a fiftieth of the channel's standard
//          deviation; while that of no other channel has doubled.
//
// Samples that are held over several rows count once. A fault that takes most of the rows is their
// usual state and is not found here.
#pragma once

#include <string_view>
#include <vector>

#include "identification/samples/record.hpp"

namespace reident::identification {

enum class SensorFaultKind { stuck, spike, noise };
/// "stuck", "spike" or "noise".
std::string_view name(SensorFaultKind kind);

struct SensorFault {
  SensorFaultKind kind = SensorFaultKind::stuck;
  Index channel = 0;  // inputs first, then outputs
  TickRange ticks;
};

/// `analog` says of each channel whether it is looked at: one that counts or switches repeats and
/// jumps by nature. By channel, then kind, then time. The cost is linear in the rows.
std::vector<SensorFault> sensor_faults(const Record& record, const std::vector<bool>& analog);

}  // namespace reident::identification
