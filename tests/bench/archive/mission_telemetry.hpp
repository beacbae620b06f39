// Telemetry of a mission's size at 1 Hz, for as long as it is asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::bench {

/// A day of the reference spacecraft, repeated for ever. Its points are repeated as well: parameter
/// i (from 0, with the id i + 1) reads point i % points in a day that began i / points * 3571 s
/// ago, so that neither neighbours nor the chunks of one time are alike.
class MissionTelemetry {
 public:
  explicit MissionTelemetry(std::size_t parameters);

  std::size_t parameters() const { return parameters_; }
  /// Generation time of frame k.
  static storage::Time time(std::uint64_t k);
  /// The frame whose generation time is `time`, and those after it have larger numbers.
  static std::uint64_t frame_at(storage::Time time);
  double value(std::size_t parameter, std::uint64_t k) const;

  /// Makes `frame` the k-th of `spacecraft`; its memory is used again.
  void fill(std::uint64_t k, const std::string& spacecraft, storage::TelemetryFrame& frame) const;
  std::vector<storage::ParameterDescriptor> descriptors(const std::string& spacecraft) const;

 private:
  std::size_t parameters_;
  std::size_t points_;
  std::vector<double> day_;  // second by second
};

}  // namespace reident::bench
