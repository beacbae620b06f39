// How soon the rule tells a better version: the true ratio of errors against cycles until the
// change, for errors of several kinds. Versions here are errors alone, drawn; the rule is the
// service's.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace reident::trust {

/// How the errors of a version follow each other: independent; with a time constant of a cycle; or
/// in bursts, as when a load is switched now and then.
enum class ErrorKind { white, slow, bursty };
std::string_view name(ErrorKind kind);

/// Sequences of one kind and one ratio of the version's error to the champion's.
struct PowerPoint {
  ErrorKind kind = ErrorKind::white;
  double ratio = 1;
  int sequences = 0;
  std::vector<std::optional<double>> cycles;  // until the change; absent: none in followed_cycles

  /// Median of the cycles; absent where half of the sequences, or more, saw no change.
  std::optional<double> median() const;
  int changed() const;
};

inline constexpr int followed_cycles = 120;

/// Ratios of a table: equal versions, and better ones.
inline const std::vector<double> power_ratios = {1.0, 0.9, 0.75, 0.5, 0.25};

/// Every kind with each of the ratios, `sequences` of both, drawn from `seed`.
std::vector<PowerPoint> power_curves(std::uint64_t seed, int sequences,
                                     const std::vector<double>& ratios = power_ratios);

/// In Markdown.
std::string power_table(const std::vector<PowerPoint>& points);

}  // namespace reident::trust
