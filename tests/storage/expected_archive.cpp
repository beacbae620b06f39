#include "tests/storage/expected_archive.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace reident::storage::test {
namespace {

constexpr TimeRange always{std::numeric_limits<Time>::min(), std::numeric_limits<Time>::max()};

std::uint64_t bits(double value) {
  return std::isnan(value) ? ~std::uint64_t{0} : std::bit_cast<std::uint64_t>(value);
}

std::string text(const SequenceGap& gap) {
  return gap.source + " " + std::to_string(gap.first) + ".." + std::to_string(gap.last) + " at " +
         std::to_string(gap.before) + ".." + std::to_string(gap.after);
}

std::string text(const SourceCounts& counts) {
  std::string line = counts.spacecraft + " " + counts.source;
  for (const std::uint64_t count :
       {counts.frames, counts.samples, counts.duplicates, counts.conflicts, counts.late,
        counts.non_finite, counts.out_of_order, counts.restarts, counts.missing,
        counts.last_sequence})
    line += " " + std::to_string(count);
  return line;
}

std::string unlike(const std::string& what, const std::string& found, const std::string& expected) {
  return what + " is [" + found + "], not [" + expected + "]";
}

}  // namespace

void ExpectedArchive::append(const std::vector<TelemetryFrame>& batch) {
  for (const TelemetryFrame& frame : batch) {
    Source& source = sources_[{frame.spacecraft, frame.source, frame.origin}];
    SourceCounts& counts = source.counts;
    ++counts.frames;
    if (!source.frames.empty() && frame.sequence <= source.frames.rbegin()->first)
      ++counts.out_of_order;
    source.frames.try_emplace(frame.sequence, frame.generation_time);
    for (const Sample& sample : frame.samples) add(frame, sample, counts);
  }
}

void ExpectedArchive::add(const TelemetryFrame& frame, const Sample& sample, SourceCounts& counts) {
  Kept incoming{sample.value, sample.quality};
  ++counts.samples;
  if (!std::isfinite(sample.value)) incoming.quality = Quality::invalid, ++counts.non_finite;
  auto& series = series_[{frame.spacecraft, frame.origin, sample.parameter}];
  const auto [kept, is_new] = series.try_emplace(frame.generation_time, incoming);
  if (is_new) {
    if (std::next(kept) != series.end()) ++counts.late;
    return;
  }
  ++(bits(kept->second.value) == bits(incoming.value) ? counts.duplicates : counts.conflicts);
  if (frame.origin == Origin::real && kept->second.quality == Quality::good &&
      incoming.quality == Quality::good && kept->second.value != incoming.value)
    kept->second.quality = Quality::disputed;
  if (kept->second.quality != Quality::disputed &&
      is_better(incoming.quality, kept->second.quality))
    kept->second = incoming;
}

std::uint64_t ExpectedArchive::frames() const {
  std::uint64_t sum = 0;
  for (const auto& [key, source] : sources_) sum += source.counts.frames;
  return sum;
}

std::string ExpectedArchive::difference_of_samples(const Archive& archive) const {
  std::uint64_t total = 0;
  for (const auto& [key, samples] : series_) {
    const auto& [spacecraft, origin, parameter] = key;
    const Series found = archive.read(spacecraft, origin, parameter, always);
    const std::string name = "parameter " + std::to_string(parameter) + " of origin " +
                             std::to_string(static_cast<int>(origin));
    total += samples.size();
    std::size_t i = 0;
    for (auto sample = samples.begin(); sample != samples.end(); ++sample, ++i) {
      if (i == found.time.size() || found.time[i] > sample->first)
        return name + " has no sample at " + std::to_string(sample->first);
      if (found.time[i] < sample->first)
        return name + " has a sample too many at " + std::to_string(found.time[i]);
      if (bits(found.value[i]) != bits(sample->second.value) ||
          found.quality[i] != sample->second.quality)
        return name + " has another value or quality at " + std::to_string(sample->first);
    }
    if (found.time.size() != samples.size()) return name + " has samples behind its last one";
  }
  const std::uint64_t count = archive.sample_count();
  return count == total ? "" : unlike("sample count", std::to_string(count), std::to_string(total));
}

std::string ExpectedArchive::difference_of_sources(const Archive& archive) const {
  const std::vector<SourceCounts> found = archive.sources();
  if (found.size() != sources_.size())
    return unlike("number of sources", std::to_string(found.size()),
                  std::to_string(sources_.size()));
  auto next = found.begin();
  for (const auto& [key, source] : sources_) {
    SourceCounts counts = source.counts;
    std::tie(counts.spacecraft, counts.source, counts.origin) = key;
    const std::uint64_t first = source.frames.begin()->first, last = source.frames.rbegin()->first;
    counts.missing = last - first + 1 - source.frames.size();
    counts.last_sequence = last;
    if (text(*next) != text(counts)) return unlike("source", text(*next), text(counts));
    ++next;
  }
  return "";
}

std::string ExpectedArchive::difference_of_gaps(const Archive& archive) const {
  const std::vector<SequenceGap> found = archive.sequence_gaps();
  auto next = found.begin();
  for (const auto& [key, source] : sources_)
    for (auto after = std::next(source.frames.begin()); after != source.frames.end(); ++after) {
      const auto before = std::prev(after);
      if (after->first == before->first + 1) continue;
      const SequenceGap gap{std::get<0>(key), std::get<1>(key), std::get<2>(key), before->first + 1,
                            after->first - 1, before->second,   after->second};
      if (next == found.end()) return "there is no gap " + text(gap);
      if (text(*next) != text(gap)) return unlike("gap", text(*next), text(gap));
      ++next;
    }
  return next == found.end() ? "" : "there is a gap too many: " + text(*next);
}

std::string ExpectedArchive::difference(const Archive& archive) const {
  std::string difference = difference_of_samples(archive);
  if (difference.empty()) difference = difference_of_sources(archive);
  if (difference.empty()) difference = difference_of_gaps(archive);
  return difference;
}

}  // namespace reident::storage::test
