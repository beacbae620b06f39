// A source that reads each stretch of each parameter once, and from then on gives what it read.
//
// For one look at an archive: several relations bind the parameters that an equipment has too.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "storage/types/sample_source.hpp"

namespace reident {

class CachingSource final : public storage::SampleSource {
 public:
  /// `source` must outlive this.
  explicit CachingSource(const storage::SampleSource& source) : source_(source) {}

  std::optional<storage::ParameterDescriptor> parameter(const std::string& spacecraft,
                                                        const std::string& name) const override;
  storage::Series read(const std::string& spacecraft, storage::Origin origin,
                       std::uint32_t parameter, storage::TimeRange range) const override;

 private:
  const storage::SampleSource& source_;
  mutable std::map<std::pair<std::string, std::string>, std::optional<storage::ParameterDescriptor>>
      described_;
  mutable std::map<
      std::tuple<std::string, storage::Origin, std::uint32_t, storage::Time, storage::Time>,
      storage::Series>
      read_;
};

}  // namespace reident
