#include "service/cli/output/far_telemetry.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "service/support/time_text.hpp"

namespace reident::cli {
namespace {

constexpr storage::Time far_ns = 365 * 86'400 * storage::second_ns;

}  // namespace

std::vector<FarTelemetry> far_telemetry(const storage::TimeBins& bins,
                                        const std::vector<std::uint64_t>& came) {
  std::vector<FarTelemetry> stretches;
  for (std::size_t bin = 0; bin < came.size(); ++bin) {
    if (came[bin] == 0) continue;
    const storage::TimeRange range = bins.at(bin);
    if (stretches.empty() || range.begin - stretches.back().range.end >= far_ns)
      stretches.push_back({range, 0});
    stretches.back().range.end = range.end;
    stretches.back().samples += came[bin];
  }
  const auto most = std::max_element(
      stretches.begin(), stretches.end(),
      [](const FarTelemetry& a, const FarTelemetry& b) { return a.samples < b.samples; });
  if (most != stretches.end()) stretches.erase(most);
  return stretches;
}

std::string sentence(const FarTelemetry& far) {
  return fmt::format(
      "{} samples from {} to {} lie more than a year from the rest; where the clock of their file "
      "was "
      "read wrongly, 'reident import --undo FILE' removes them",
      far.samples, time_text(far.range.begin), time_text(far.range.end));
}

}  // namespace reident::cli
