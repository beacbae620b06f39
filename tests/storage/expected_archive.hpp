// What an archive holds after some batches, by the rules of archive.hpp in the most direct words:
// a map of samples and a set of sequence numbers.
#pragma once

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "storage/archive/archive.hpp"

namespace reident::storage::test {

class ExpectedArchive {
 public:
  void append(const std::vector<TelemetryFrame>& batch);
  /// Frames appended so far, repeated ones too.
  std::uint64_t frames() const;

  /// Empty where the archive holds just this: values to the bit, qualities, counts of the sources,
  /// sequence gaps. Else what is different first.
  std::string difference(const Archive& archive) const;

 private:
  using SeriesKey = std::tuple<std::string, Origin, std::uint32_t>;
  using SourceKey = std::tuple<std::string, std::string, Origin>;
  struct Kept {
    double value = 0;
    Quality quality = Quality::good;
  };
  struct Source {
    SourceCounts counts;
    std::map<std::uint64_t, Time> frames;  // generation time by sequence number
  };

  void add(const TelemetryFrame& frame, const Sample& sample, SourceCounts& counts);
  std::string difference_of_samples(const Archive& archive) const;
  std::string difference_of_sources(const Archive& archive) const;
  std::string difference_of_gaps(const Archive& archive) const;

  std::map<SeriesKey, std::map<Time, Kept>> series_;
  std::map<SourceKey, Source> sources_;
};

}  // namespace reident::storage::test
