// Small random streams of our own: the same numbers with every standard library, whose
// distributions are not laid down. log, sin and cos are those of the C library, so gaussian()
// repeats on one machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace reident::satcs {

/// SplitMix64 (Steele, Lea and Flood, 2014): one step of mixing, good enough to hash with.
constexpr std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// Returns a number in [0, 1) from the upper 53 bits.
constexpr double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// One sequence of numbers. Not thread-safe; streams are cheap, one for each purpose.
class RandomStream {
 public:
  /// Streams of one seed with different numbers are independent of each other.
  RandomStream(std::uint64_t seed, std::uint64_t stream) : state_(mix(mix(seed) ^ stream)) {}

  /// In [0, 1).
  double uniform() { return unit_interval(next()); }

  /// Mean 0, variance 1 (Box and Muller).
  double gaussian() {
    if (spare_ready_) {
      spare_ready_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    spare_ready_ = true;
    return radius * std::cos(angle);
  }

 private:
  std::uint64_t next() { return mix(state_++); }

  std::uint64_t state_;
  double spare_ = 0;
  bool spare_ready_ = false;
};

}  // namespace reident::satcs
