// Samples of a parameter by name and time: what a window is made of, wherever the archive is.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// Samples of one series, ascending in time.
struct Series {
  std::vector<Time> time;
  std::vector<double> value;
  std::vector<Quality> quality;
  std::vector<std::int64_t> source;  // ids of the sources; where they were asked for
};

class SampleSource {
 public:
  virtual ~SampleSource() = default;

  /// Of several with one name the lowest id.
  virtual std::optional<ParameterDescriptor> parameter(const std::string& spacecraft,
                                                       const std::string& name) const = 0;
  /// Samples with a generation time in `range`.
  virtual Series read(const std::string& spacecraft, Origin origin, std::uint32_t parameter,
                      TimeRange range) const = 0;
};

}  // namespace reident::storage
