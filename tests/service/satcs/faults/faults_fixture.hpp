// Telemetry to fault about, and what the ground receives of it.
#pragma once

#include <string>
#include <vector>

#include "service/satcs/faults/fault_injector.hpp"

namespace reident::satcs::test {

using storage::Time;

inline constexpr Time second = 1'000'000'000;
inline constexpr Time start = 1'498'867'200 * second;
/// A and B are analog, S is digital.
inline constexpr std::uint32_t a_id = 1, b_id = 2, s_id = 3;
/// So much telemetry there is; faults are from 600 s to 2400 s.
inline constexpr std::size_t truth_s = 3600, from_s = 600, to_s = 2400;
inline const std::string fault_range = "@+10min/+40min";

std::vector<storage::ParameterDescriptor> parameters();
/// What A measures, in the second k.
double a_at(std::size_t k);
/// A at 1 Hz, B every other second, S every tenth, from "station", numbered from 1000.
std::vector<storage::TelemetryFrame> true_frames(std::size_t seconds = truth_s);

/// Whether they are the same to the last bit.
bool same(const storage::TelemetryFrame& one, const storage::TelemetryFrame& other);

/// Throws std::runtime_error.
Fault fault_of(const std::string& text, std::uint64_t seed = 1);
std::vector<storage::TelemetryFrame> received(std::vector<storage::TelemetryFrame> truth,
                                              const std::vector<Fault>& faults);

}  // namespace reident::satcs::test
