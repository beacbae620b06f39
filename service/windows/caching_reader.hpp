// A reader that reads each range of each parameter once, and from then on gives what it read.
//
// For one reading of a window: several relations bind the parameters that an equipment has too.
// What is stored meanwhile does not change what it gives.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "storage/types/sample_reader.hpp"

namespace reident {

/// Keeps all that it has read until it ends, which is at the end of one load. One thread at a time.
/// Throws what its reader throws, and keeps nothing then.
class CachingReader final : public storage::SampleReader {
 public:
  /// `reader` must outlive this.
  explicit CachingReader(const storage::SampleReader& reader) : reader_(reader) {}

  /// Absent where it was absent at the first call.
  std::optional<storage::ParameterDescriptor> parameter(const std::string& spacecraft,
                                                        const std::string& name) const override;
  /// A copy. A range is looked up as a whole: one that overlaps another is read again.
  storage::Series read(const std::string& spacecraft, storage::Origin origin,
                       std::uint32_t parameter, storage::TimeRange range) const override;

 private:
  const storage::SampleReader& reader_;
  mutable std::map<std::pair<std::string, std::string>, std::optional<storage::ParameterDescriptor>>
      described_;
  mutable std::map<
      std::tuple<std::string, storage::Origin, std::uint32_t, storage::Time, storage::Time>,
      storage::Series>
      read_;
};

}  // namespace reident
