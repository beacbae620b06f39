#include "tests/trust/power.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <fmt/format.h>

#include "service/judgement/league.hpp"

namespace reident::trust {
namespace {

constexpr int rows = 200;  // of a block
constexpr int rows_of_cycle = rows * blocks_of_cycle;
constexpr int cycles_before = 8;  // of the champion's record, before the version is made
constexpr Duration block_ns = 1'500'000'000'000;

/// Mean and mean square of a version's errors over each block.
class Errors {
 public:
  Errors(ErrorKind kind, double size, std::uint64_t seed)
      : kind_(kind), size_(size), random_(seed), state_(normal_(random_)) {}

  storage::BlockScore block(std::int64_t version, storage::Time begin) {
    double sum = 0, squares = 0;
    for (int row = 0; row < rows; ++row) {
      const double error = size_ * next();
      sum += error;
      squares += error * error;
    }
    return {version, begin, rows, {sum / rows}, {squares / rows}, {1e-12}, {}, {}};
  }

 private:
  /// Of mean square 1.
  double next() {
    const double white = normal_(random_);
    if (kind_ == ErrorKind::white) return white;
    if (kind_ == ErrorKind::slow) {
      constexpr double pole = 1 - 1.0 / rows_of_cycle;
      state_ = pole * state_ + std::sqrt(1 - pole * pole) * white;
      return state_;
    }
    constexpr double share = 0.1, height = 10;  // of the bursts' squares, so that the mean is 1
    if (left_-- <= 0) {
      is_burst_ = uniform_(random_) < share;
      left_ = rows / 4;
    }
    constexpr double rest = (1 - share * height * 0.9) / (1 - share);
    return white * std::sqrt(is_burst_ ? height * 0.9 : rest);
  }

  ErrorKind kind_;
  double size_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  double state_;
  bool is_burst_ = false;
  int left_ = 0;
};

/// Cycles until the version would become champion.
std::optional<double> cycles_until_change(ErrorKind kind, double ratio, std::uint64_t seed) {
  constexpr int before = cycles_before * blocks_of_cycle;
  EquipmentConfig limits;
  limits.cycle = block_ns * blocks_of_cycle;
  limits.max_mrse_percent = 100;
  Errors of_champion(kind, 1, 2 * seed), of_version(kind, ratio, 2 * seed + 1);
  League league;
  Judge judge(limits);
  league.champion = Member{1, {-limits.cycle * 8, 0}, 0, {}};
  const storage::TimeRange window{(before - 8 * blocks_of_cycle) * block_ns, before * block_ns};
  league.challengers = {Member{2, window, window.end, {}}};
  league.admitted = {window};
  for (int i = 0; i < before + followed_cycles * blocks_of_cycle; ++i) {
    const storage::Time begin = i * block_ns;
    league.blocks.push_back({{begin, begin + block_ns}, rows, 1, {10}, {110}, {-1}, {1}, {}});
    league.champion->scores.push_back(of_champion.block(1, begin));
    if (i < before) continue;
    league.challengers[0].scores.push_back(of_version.block(2, begin));
    if (successor(judge.findings(league)))
      return static_cast<double>(i + 1 - before) / blocks_of_cycle;
  }
  return std::nullopt;
}

}  // namespace

std::string_view name(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::white:
      return "white";
    case ErrorKind::slow:
      return "slow";
    case ErrorKind::bursty:
      return "bursty";
  }
  return "";
}

std::optional<double> PowerPoint::median() const {
  std::vector<double> sorted;
  for (const auto& one : cycles) sorted.push_back(one.value_or(INFINITY));
  std::sort(sorted.begin(), sorted.end());
  const double middle = sorted.empty() ? INFINITY : sorted[sorted.size() / 2];
  return std::isfinite(middle) ? std::optional(middle) : std::nullopt;
}

int PowerPoint::changed() const {
  return static_cast<int>(
      std::count_if(cycles.begin(), cycles.end(), [](const auto& one) { return one.has_value(); }));
}

std::vector<PowerPoint> power_curves(std::uint64_t seed, int sequences,
                                     const std::vector<double>& ratios) {
  std::vector<PowerPoint> points;
  std::mt19937_64 seeds(seed);
  for (const ErrorKind kind : {ErrorKind::white, ErrorKind::slow, ErrorKind::bursty})
    for (const double ratio : ratios) {
      PowerPoint point{kind, ratio, sequences, {}};
      for (int i = 0; i < sequences; ++i)
        point.cycles.push_back(cycles_until_change(kind, ratio, seeds()));
      points.push_back(std::move(point));
    }
  return points;
}

std::string power_table(const std::vector<PowerPoint>& points) {
  std::string text = fmt::format(
      "| errors | ratio | sequences | changed within {} cycles | cycles, median |\n"
      "|---|---|---|---|---|\n",
      followed_cycles);
  for (const PowerPoint& point : points) {
    const auto median = point.median();
    text +=
        fmt::format("| {} | {:g} | {} | {} | {} |\n", name(point.kind), point.ratio,
                    point.sequences, point.changed(), median ? fmt::format("{:g}", *median) : "");
  }
  return text;
}

}  // namespace reident::trust
