// Samples of a parameter by name and time: what a window is made of, wherever the archive is.
//
// The archive implements it on a file (archive.hpp). Others may hand on what they keep, or read as
// little as they can.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// Samples of one series, one row a sample, strictly ascending in time. All columns have one
/// length, but `source`, which may be empty.
struct Series {
  std::vector<Time> time;
  std::vector<double> value;
  std::vector<Quality> quality;
  /// Ids of the sources; where they were asked for.
  std::vector<std::int64_t> source;
};

/// Reads telemetry. What it reads does not change it.
class SampleReader {
 public:
  virtual ~SampleReader() = default;

  /// The descriptor of a parameter by its name; of several with one name that of the lowest id.
  /// Absent where no descriptor has the name.
  virtual std::optional<ParameterDescriptor> parameter(const std::string& spacecraft,
                                                       const std::string& name) const = 0;
  /// Samples with a generation time in `range`; none where the series is not known. Ids of sources
  /// may be left out. Throws Error (corrupt) where samples cannot be decoded.
  virtual Series read(const std::string& spacecraft, Origin origin, std::uint32_t parameter,
                      TimeRange range) const = 0;
};

}  // namespace reident::storage
