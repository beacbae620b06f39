// Telemetry in memory, as the service would read it from an archive: what the truth is kept in.
#pragma once

#include <map>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "storage/types/sample_reader.hpp"

namespace reident::trust {

/// Holds one spacecraft and origin, whatever a caller asks for; samples come in the order of time
/// and are good.
class KnownSeries : public storage::SampleReader {
 public:
  /// Keeps those of the descriptors whose names are in `names`.
  KnownSeries(std::span<const storage::ParameterDescriptor> descriptors,
              const std::vector<std::string>& names);

  /// Samples of parameters that are not kept are left out.
  void append(storage::Time time, std::span<const storage::Sample> samples);

  std::optional<storage::ParameterDescriptor> parameter(const std::string& spacecraft,
                                                        const std::string& name) const override;
  storage::Series read(const std::string& spacecraft, storage::Origin origin,
                       std::uint32_t parameter, storage::TimeRange range) const override;

 private:
  struct Channel {
    std::vector<storage::Time> time;
    std::vector<double> value;
  };
  std::map<std::string, storage::ParameterDescriptor> descriptors_;  // by name
  std::unordered_map<std::uint32_t, Channel> channels_;
};

}  // namespace reident::trust
