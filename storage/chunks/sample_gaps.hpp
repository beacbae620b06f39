// Where samples of a parameter are missing, by its generation times alone.
//
// Nobody says how often a parameter is sampled, so the times have to. Let d be the differences of
// neighbouring times in a range and `step` their lower median. The range is regular where at
// least three quarters of d are within half a step of the step, and where most of the longer ones
// stand alone, with such a difference after them: single samples are missing then, whereas
// longer differences side by side are another rate. A difference is a gap where it is above
//
//   regular range     step + max(step / 2, min(step, 5 (step - d_16)))
//   any other         1.5 d_95
//
// with the percentiles d_16 and d_95. A missing sample cannot make a difference shorter: the lower
// side shows the jitter alone (one standard deviation where it is Gaussian), and 5 of it keep
// jitter from passing for a gap. So each sample that a regular parameter lacks is a gap, even when
// it lacks every fifth, and what comes only when it changes has a gap only in its rare long pauses.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "storage/types/telemetry.hpp"

namespace reident::storage {

/// How a range of one parameter is sampled [ns].
struct Sampling {
  Time step = 0;   // lower median of the differences; 0 with fewer than 2 samples
  Time limit = 0;  // a longer difference is a gap; 0, no limit, with fewer than 2 samples
  bool operator==(const Sampling&) const = default;
};

/// Two neighbouring samples of a series between which others are missing.
struct SampleGap {
  Time begin = 0;
  Time end = 0;
  bool operator==(const SampleGap&) const = default;
};

/// One thread at a time; keeps its memory, 8 bytes a sample, between ranges.
class SamplingMeter {
 public:
  /// Times strictly ascend. Costs time in proportion to their number.
  Sampling measure(std::span<const Time> times);

 private:
  std::vector<std::uint64_t> differences_;
};

/// Appends the gaps between neighbours in `times`, which strictly ascend.
void append_gaps(std::span<const Time> times, const Sampling& sampling,
                 std::vector<SampleGap>& gaps);

/// The gap between the last sample of a range and the first one of the next, if there is one:
/// their distance is above the larger limit of the two. None where neither has a limit.
std::optional<SampleGap> gap_between(Time last, const Sampling& before, Time first,
                                     const Sampling& after);

}  // namespace reident::storage
