#include "service/dds/network_cut.hpp"

#include <algorithm>
#include <cmath>

namespace reident::dds {
namespace {

using namespace std::chrono_literals;

// The middleware's own lease: how late the end of a cut may be noticed.
constexpr auto default_lease = 10s;
// What comes until two participants have found each other again.
constexpr auto reconnection = 15s;
constexpr std::uint64_t default_unacknowledged = 500'000;  // Internal/Watermarks/WhcHigh
constexpr std::uint64_t bytes_of_a_frame = 256;            // with its names, without samples
constexpr std::uint64_t bytes_of_a_sample = 16;            // number, value and quality

}  // namespace

CutSettings settings_for(const NetworkCut& cut, std::size_t parameters) {
  const double seconds = std::chrono::duration<double>(cut.length + reconnection).count();
  const double frames = std::ceil(cut.frames_per_s * seconds);
  return {
      cut.length + default_lease, static_cast<std::int32_t>(std::min(frames, 2e9)),
      std::max(default_unacknowledged, static_cast<std::uint64_t>(frames) *
                                           (bytes_of_a_frame + bytes_of_a_sample * parameters))};
}

}  // namespace reident::dds
